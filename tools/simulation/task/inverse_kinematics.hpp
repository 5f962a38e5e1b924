// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/arm_dynamics.hpp"

#include <string>

namespace dfdyn::tools {

/// Joint motion that moves the tip (position only) of a chain within the joints' limits, by damped least
/// squares. The remaining degrees of freedom move towards a rest posture. A joint slows down near a limit and
/// stops shortly before it; other joints then compensate for it.
class InverseKinematics {
  public:
    explicit InverseKinematics(const Robot& robot);

    /// Returns the smallest joint motion that moves the tip by `tip_motion`, plus `pull`, projected so that
    /// it moves the tip as little as possible. No joint moves by more than `approach` times its distance to a
    /// limit. All quantities are per second, or all for one step.
    JointVector move(const JointVector& position, const Eigen::Vector3d& tip_motion, const JointVector& pull,
                     double approach);

    /// Returns a posture within the limits whose tip is nearest to `target`, starting from `position` and
    /// close to `rest`. Iterates until convergence.
    JointVector reach(JointVector position, const Eigen::Vector3d& target, const JointVector& rest);

    Eigen::Vector3d tip(const JointVector& position);

    /// Returns the joints that are at a limit, for a message: `r_elbow at its upper limit 1.85 rad`, or `no
    /// joint at a limit`.
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
