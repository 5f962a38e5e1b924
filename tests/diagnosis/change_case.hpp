// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/cause.hpp"
#include "tests/diagnosis/panel_setup.hpp"
#include "tools/monitor/monitored_estimator.hpp"

#include <optional>

namespace dfdyn::tests {

/// A simulated arm that learns, and what changes meanwhile.
struct ChangeCase {
    std::uint64_t seed = 0;
    std::string robot_name;
    std::optional<Cause> cause; ///< none: nothing changes
    double time_s = 0;          ///< of the change
    double end_s = 0;           ///< of a contact; of others the recording's
    std::string where;          ///< as the monitor names it
    std::string size;           ///< in words
    tools::Recording recording; ///< 100 rows per second
};

/// What is fixed in a panel of changes.
struct ChangeMix {
    std::optional<std::string> robot; ///< of change_robot_names()
    std::optional<Cause> cause;
    bool never = false; ///< nothing changes
    double duration_s = 100;
};

/// ur5_torque, icub_wrench, three_joint_torque.
const std::vector<std::string>& change_robot_names();

/// The case of `seed`: motion, noise, cause, time, place and size are random; the same seed gives the same
/// bytes. A bias and a frozen reading are put into the recording, everything else is simulated.
ChangeCase make_change_case(std::uint64_t seed, const ChangeMix& mix);

/// What is replayed over a case: rigid body, friction and offsets, trained on its first 25 s and learning on.
struct ChangeModel {
    tools::TrainedModel model;
    tools::MonitorSetup monitor;
};
ChangeModel train_change_model(const ChangeCase& one);

} // namespace dfdyn::tests
