// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/stretches.hpp"
#include "tools/robot/motion.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// A recording on a uniform clock, with smoothed positions and their derivatives. The filters have zero
/// phase, so the result is for offline use only.
struct MeasuredMotion {
    double rate_hz = 0; ///< of the rows below
    /// n: cutoff of the positions' low-pass filter, below the frequency where noise dominates
    Eigen::VectorXd smoothing_hz;
    Eigen::VectorXd time_s;  ///< T
    RobotMotion motion;      ///< T x n
    Eigen::MatrixXd outputs; ///< T x m, filtered against aliasing only
    Eigen::VectorXd
        velocity_noise; ///< n, rad/s: standard deviation of the velocities that the position noise causes
    Eigen::VectorXd response_bandwidth_hz; ///< m: outputs are used up to it; empty: without a limit
    Eigen::MatrixXd weight; ///< T x m, 0 to 1: weight of each row of an output; empty: all have weight 1
    std::vector<Stretch> stretches; ///< in order; none shorter than `shortest_stretch_s`

    static constexpr double shortest_stretch_s = 2;
};

/// Resamples a recording to a uniform clock by cubic interpolation. The rate is the median rate, or an
/// integer fraction of it (60 to 130 Hz) if the median rate is higher. Segments end at gaps (`gap_before`, or
/// a step longer than three times the median). The noise level of the positions (quantization and encoder,
/// from the top of their spectrum) determines the frequency up to which they are trusted. Throws InputError
/// if no segment is long enough.
MeasuredMotion measured_motion(const Recording& recording);

} // namespace dfdyn::tools
