// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Noise of measured positions, with one entry per joint.
struct PositionNoise {
    Eigen::VectorXd power; ///< rad² (m²): variance of the white noise with the same level below a few Hz
    Eigen::VectorXd trusted_hz; ///< the positions are well above the noise up to this frequency
};

/// Estimates the noise of positions (T x n each, segments of a recording) on a uniform clock. Its level is
/// the larger one of two: the top of the positions' spectrum, and the rounding by an encoder. The rounding of
/// a fast joint is white noise; that of a slow one changes only with each count, so that its power is at low
/// frequencies, and the top of the spectrum does not show it. Accelerations at frequencies that are not
/// trusted would be noise and would resemble another inertia. `quantum`: counts of the encoders (rad, m), 0:
/// unknown.
PositionNoise position_noise(const std::vector<Eigen::MatrixXd>& positions, const Eigen::VectorXd& quantum,
                             double rate_hz);

} // namespace dfdyn::tools
