// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/arm_dynamics.hpp"

#include <string>

namespace dfdyn::tools {

/// Joint motion that moves the tip (position only) of a chain within the joints' limits, by damped least
/// squares; what the tip leaves free pulls towards a rest posture. A joint slows down as it comes near a
/// limit, as through a damper, and stops a little before it; the others then take over its part.
class InverseKinematics {
  public:
    explicit InverseKinematics(const Robot& robot);

    /// The smallest joint motion that moves the tip by `tip_motion`, plus `pull` projected so that it moves
    /// the tip as little as possible; no joint moves by more than `approach` times its way to a limit. All
    /// per second, or all for one step.
    JointVector move(const JointVector& position, const Eigen::Vector3d& tip_motion, const JointVector& pull,
                     double approach);

    /// The posture within the limits, near `position` and close to `rest`, whose tip is nearest to `target`:
    /// iterations until it settles.
    JointVector reach(JointVector position, const Eigen::Vector3d& target, const JointVector& rest);

    Eigen::Vector3d tip(const JointVector& position);

    /// The joints that are at a limit, for a message: `r_elbow at its upper limit 1.85 rad`; or `no joint at
    /// a limit`.
    std::string joints_at_limits(const JointVector& position) const;

  private:
    JointVector solve(const Eigen::Vector3d& tip_motion, const JointVector& pull,
                      const JointVector& held) const;

    ArmDynamics dynamics_;
    ArmDynamics::Configuration configuration_;
    JointVector lower_, upper_; ///< where joints stop
    PointJacobian jacobian_;
};

} // namespace dfdyn::tools
