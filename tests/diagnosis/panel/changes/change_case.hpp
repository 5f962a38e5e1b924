// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/cause.hpp"
#include "tests/diagnosis/panel/recording/panel_setup.hpp"
#include "tools/monitor/monitored_estimator.hpp"

#include <optional>

namespace dfdyn::tests {

/// A simulated arm whose model learns while something changes.
struct ChangeCase {
    std::uint64_t seed = 0;
    std::string robot_name;
    std::optional<Cause> cause; ///< empty if nothing changes
    double time_s = 0;          ///< of the change
    double end_s = 0;           ///< end of a contact; for other changes the end of the recording
    std::string where;          ///< place as the monitor names it
    std::string size;           ///< size of the change in words
    tools::Recording recording; ///< 100 rows per second
};

/// Fixed properties of a panel of changes.
struct ChangeMix {
    std::optional<std::string> robot; ///< of change_robot_names()
    std::optional<Cause> cause;
    bool never = false; ///< nothing changes
    double duration_s = 100;
};

/// Returns ur5_torque, icub_wrench and three_joint_torque.
const std::vector<std::string>& change_robot_names();

/// Makes the case of `seed`. Motion, noise, cause, time, place and size are random; equal seeds give equal
/// bytes. A bias and a frozen reading are written into the recording; everything else is simulated.
ChangeCase make_change_case(std::uint64_t seed, const ChangeMix& mix);

/// The model that is replayed over a case: rigid body, friction and offsets. It is trained on the first 25 s
/// and keeps learning.
struct ChangeModel {
    tools::TrainedModel model;
    tools::MonitorSetup monitor;
};
ChangeModel train_change_model(const ChangeCase& one);

} // namespace dfdyn::tests
