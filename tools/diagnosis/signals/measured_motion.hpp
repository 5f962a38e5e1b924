// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/stretches.hpp"
#include "tools/robot/motion.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// A recording on a uniform clock, its positions smoothed, with derivatives: zero phase, so for use offline
/// only.
struct MeasuredMotion {
    double rate_hz = 0;           ///< of the rows below
    Eigen::VectorXd smoothing_hz; ///< n: positions were low-passed here, before they sink into their noise
    Eigen::VectorXd time_s;       ///< T
    RobotMotion motion;           ///< T x n
    Eigen::MatrixXd outputs;      ///< T x m, low-passed only against aliasing
    Eigen::VectorXd
        velocity_noise; ///< n, rad/s: standard deviation that the positions' noise leaves in the velocities
    Eigen::VectorXd answered_hz;    ///< m: outputs count up to this frequency; empty: up to any
    Eigen::MatrixXd weight;         ///< T x m, 0 to 1: how much each row of an output counts; empty: all do
    std::vector<Stretch> stretches; ///< in order; none shorter than `shortest_stretch_s`

    static constexpr double shortest_stretch_s = 4;
};

/// Puts a recording on a uniform clock of its median rate, or an integer part of it (60 to 130 Hz) where that
/// is higher, by cubic interpolation. Stretches end at gaps (`gap_before`, or steps above three times the
/// median). The positions' own noise level (of quantiser and encoder, taken from the top of their spectrum)
/// decides up to which frequency they are trusted. Throws InputError when no stretch is long enough.
MeasuredMotion measured_motion(const Recording& recording);

} // namespace dfdyn::tools
