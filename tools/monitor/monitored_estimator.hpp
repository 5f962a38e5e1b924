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

/// A verdict on a change, for who acts on it.
struct Verdict {
    std::size_t number = 0; ///< of the change, from 1
    Cause cause = Cause::unknown;
    double confidence = 0;     ///< 0 … 1
    int joint = -1;            ///< from 0; -1: none in particular
    std::vector<double> moved; ///< by how much each output's offset moved; of a bias, else zeros
};

/// An estimator with a monitor (dfdyn::Monitor) beside it.
class MonitoredEstimator : public HostEstimator {
  public:
    /// What it found, not yet taken; the newest 256.
    virtual std::vector<NamedChange> changes() const = 0;
    /// Likewise, and takes them.
    virtual std::vector<NamedChange> take_changes() = 0;
    /// The last verdict, once: null if there was none since the last call. It lives until the next tick;
    /// nothing is allocated.
    virtual const Verdict* take_verdict() = 0;
};

std::unique_ptr<MonitoredEstimator> monitored(std::unique_ptr<HostEstimator> estimator,
                                              const MonitorSetup& setup);

} // namespace dfdyn::tools
