// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/setup_check/rigid_body/rigid_comparison.hpp"
#include "tools/setup_check/setup_finding.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace dfdyn::tools {

/// An alternative interpretation of the columns or of the robot.
struct Reading {
    SetupFault fault;
    bool may_refuse; ///< false: a warning at most
    std::string columns;
    std::string expected, remedy;        ///< parts of the text, before and after the comparison
    std::vector<Eigen::Index> concerned; ///< affected outputs, which the text compares; empty: all
    Eigen::VectorXd left;                ///< remaining share of each output's variance
};

/// Returns the share of each output's variance that the set-up leaves, over the moving_rows().
Eigen::VectorXd shares_left(const ArmRecording& arm, const RigidParts& parts);

/// Returns the alternatives to the set-up: signs, exchanges, gravity upside down and degrees. `now`: the
/// shares_left() of the set-up. Cost: n^2 / 2 + 2 n rigid bodies along the motion.
std::vector<Reading> alternative_readings(const ArmRecording& arm, const RigidParts& parts,
                                          const Eigen::VectorXd& now);

/// Returns the zeros of each joint that turns, a quarter or half a turn away. Cost: 3 n rigid bodies.
std::vector<Reading> other_zeros(const ArmRecording& arm);

} // namespace dfdyn::tools
