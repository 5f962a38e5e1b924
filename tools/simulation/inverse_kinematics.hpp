// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/arm_dynamics.hpp"

namespace dfdyn::tools {

/// Joint velocities that move the tip (position only) of a chain, by damped least squares; what the tip
/// leaves free pulls towards a rest posture.
class InverseKinematics {
  public:
    explicit InverseKinematics(const Robot& robot);

    /// The smallest joint motion that moves the tip by `tip_motion`, plus `pull` projected so that it moves
    /// the tip as little as possible. Both per second, or both for one step.
    JointVector move(const JointVector& position, const Eigen::Vector3d& tip_motion, const JointVector& pull);

    /// The posture near `position` and close to `rest` whose tip is nearest to `target`: iterations until
    /// they settle.
    JointVector reach(JointVector position, const Eigen::Vector3d& target, const JointVector& rest);

    Eigen::Vector3d tip(const JointVector& position);

  private:
    ArmDynamics dynamics_;
    ArmDynamics::Configuration configuration_;
};

} // namespace dfdyn::tools
