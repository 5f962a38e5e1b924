// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/host/host_estimator.hpp"
#include "tools/monitor/named_change.hpp"
#include "tools/robot/robot.hpp"

#include <array>
#include <memory>

namespace dfdyn::tools {

/// What a monitor has to know of the arm.
struct MonitorSetup {
    ChainModel chain;
    std::vector<std::string> outputs;
    double sample_period_s = 0;
    std::vector<double> output_gain; ///< per output: output per N·m (N)
    Eigen::Isometry3d tip_placement =
        Eigen::Isometry3d::Identity(); ///< of the tool's frame in the last link's
    double false_alarm_hours = 5;      ///< mean time between false alarms, > 0
};

/// For outputs of `model`: the chain of its physics, or else that of `robot`. Throws InputError, naming
/// `source`, when there is neither, or the robot has not the model's joints or sensor.
MonitorSetup monitor_setup(const TrainedModel& model, const Robot* robot, const std::string& source);

/// An estimator with a monitor (dfdyn::Monitor) beside it.
class MonitoredEstimator : public HostEstimator {
  public:
    /// What it found, not yet taken; the newest 256.
    virtual std::vector<NamedChange> changes() const = 0;
    /// Likewise, and takes them.
    virtual std::vector<NamedChange> take_changes() = 0;
};

std::unique_ptr<MonitoredEstimator> monitored(std::unique_ptr<HostEstimator> estimator,
                                              const MonitorSetup& setup);

} // namespace dfdyn::tools
