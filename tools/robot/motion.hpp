// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/zero_phase_derivatives.hpp"
#include "tools/robot/robot.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// T states of n joints; rad, m, s.
struct RobotMotion {
    Eigen::MatrixXd position, velocity, acceleration; ///< T x n

    Eigen::Index rows() const { return position.rows(); }
};

/// States within the joints' limits, uniform: positions (±π, ±0.5 m where there are no limits), velocities
/// within the limits and ±3 rad/s (1 m/s), accelerations within ±10 rad/s² (5 m/s²). The same for the same
/// seed, with every standard library.
RobotMotion random_motion(const Robot& robot, Eigen::Index rows, std::uint64_t seed);

/// What a recording says of motion and outputs.
struct RecordedMotion {
    RobotMotion motion;
    Eigen::MatrixXd outputs; ///< T x m
};

/// What a recording says of motion and outputs, row by row.
struct SampledMotion {
    RecordedMotion all;              ///< as many rows as the recording
    std::vector<std::uint8_t> valid; ///< 1 where velocities and accelerations are known
};

/// As `recorded_motion`, with a row for each of the recording's. `recording` has outputs.
SampledMotion sampled_motion(const Recording& recording, const ZeroPhaseWindow& window);

/// Velocities and accelerations are the recordings' own, and otherwise derivatives of what they have
/// (`zero_phase_derivatives`); rows without a full window are left out then. Throws InputError when no row is
/// left.
RecordedMotion recorded_motion(std::span<const Recording> recordings, const ZeroPhaseWindow& window);

} // namespace dfdyn::tools
