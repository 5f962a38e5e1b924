// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/arm/simulated_arm.hpp"

#include <limits>
#include <vector>

namespace dfdyn::tools {

/// A body that is fixed to the tip at some time, as a gripper takes a part, and maybe taken off again: not in
/// the robot's URDF, and no controller knows of it.
struct Payload {
    double attached_s = 0;
    double mass = 0;                                            ///< kg, in one point
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();           ///< m, in the tip frame
    double removed_s = std::numeric_limits<double>::infinity(); ///< after `attached_s`
};

/// Attaches payloads to an arm when their time comes, and takes them off.
class PayloadSchedule {
  public:
    /// `payloads`: in the order in which they are attached.
    PayloadSchedule(std::vector<Payload> payloads, const Robot& robot);

    /// Does all that is due by `time_s`, which rises from call to call.
    void update(double time_s, SimulatedArm& arm);

  private:
    bool carried(const Payload& payload, double time_s) const noexcept {
        return payload.attached_s <= time_s && time_s < payload.removed_s;
    }
    void attach(const Payload& payload, SimulatedArm& arm) const;

    std::vector<Payload> payloads_;
    Eigen::Isometry3d tip_;
    double last_s_ = -1; ///< of the last call
};

} // namespace dfdyn::tools
