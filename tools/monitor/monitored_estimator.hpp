// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/run_time/runtime_estimator.hpp"
#include "tools/monitor/named_change.hpp"
#include "tools/robot/robot.hpp"

#include <array>
#include <memory>

namespace dfdyn::tools {

/// Description of the arm for a monitor.
struct MonitorSetup {
    ChainModel chain;
    std::vector<std::string> outputs;
    double sample_period_s = 0;
    std::vector<double> output_gain; ///< output per N·m or N, for each output
    Eigen::Isometry3d tip_placement =
        Eigen::Isometry3d::Identity(); ///< tool frame in the frame of the last link
    double false_alarm_hours = 5;      ///< mean time between false alarms, > 0
};

/// Returns the description for the outputs of `model`: with the chain of its physics, otherwise of
/// `robot`. Throws InputError, naming `source`, if there is neither, or if the robot does not have the joints
/// or the sensor of the model.
MonitorSetup monitor_setup(const TrainedModel& model, const Robot* robot, const std::string& source);

/// Cause of a change, for a caller that acts on it.
struct Verdict {
    std::size_t number = 0; ///< number of the change, from 1
    Cause cause = Cause::unknown;
    double confidence = 0;     ///< 0 … 1
    int joint = -1;            ///< from 0; -1: none in particular
    std::vector<double> moved; ///< bias: change of each output's offset; other causes: zeros
};

/// An estimator with a monitor (dfdyn::Monitor).
class MonitoredEstimator : public RuntimeEstimator {
  public:
    /// Returns the newest 256 changes since the last `take_changes`.
    virtual std::vector<NamedChange> changes() const = 0;
    /// Returns the same changes and removes them.
    virtual std::vector<NamedChange> take_changes() = 0;
    /// Returns the last verdict once, valid until the next tick; null if there is no new one since the last
    /// call. Allocates nothing.
    virtual const Verdict* take_verdict() = 0;
};

std::unique_ptr<MonitoredEstimator> monitored(std::unique_ptr<RuntimeEstimator> estimator,
                                              const MonitorSetup& setup);

} // namespace dfdyn::tools
