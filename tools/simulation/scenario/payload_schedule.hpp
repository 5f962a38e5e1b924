// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/arm/simulated_arm.hpp"

#include <limits>
#include <vector>

namespace dfdyn::tools {

/// A body that is attached to the tip at a given time, like a part in a gripper, and optionally removed
/// again. It is not in the robot's URDF, and no controller models it.
struct Payload {
    double attached_s = 0;
    double mass = 0;                                            ///< kg, point mass
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();           ///< m, in the tip frame
    double removed_s = std::numeric_limits<double>::infinity(); ///< after `attached_s`
};

/// Attaches payloads to an arm and removes them at their times.
class PayloadSchedule {
  public:
    /// `payloads`: in the order of their attachment.
    PayloadSchedule(std::vector<Payload> payloads, const Robot& robot);

    /// Attaches and removes the payloads that are due by `time_s`, which must not decrease.
    void update(double time_s, SimulatedArm& arm);

  private:
    bool carried(const Payload& payload, double time_s) const noexcept {
        return payload.attached_s <= time_s && time_s < payload.removed_s;
    }
    void attach(const Payload& payload, SimulatedArm& arm) const;

    std::vector<Payload> payloads_;
    Eigen::Isometry3d tip_;
    double last_s_ = -1; ///< time of the last call
};

} // namespace dfdyn::tools
