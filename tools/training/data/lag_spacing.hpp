// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/data/training_data.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

/// How a lag window covers time: `lags` + 1 positions, `every` samples apart. With `every` > 1 each is the
/// mean of `every` samples, which keeps motion and noise above the spacing's Nyquist frequency out. The
/// estimator still predicts and learns every tick: its rows are constant over each group of samples (see
/// dense_input()). So the window's time costs memory and multiply-adds for every sample in it, but only
/// `lags` + 1 numbers per row are learned.
struct LagSpacing {
    int lags = 10; ///< M >= 1
    int every = 1; ///< N >= 1
};

/// The spacing for a window of `window_s` at that sample period: every sample up to `most_lags` lags, else
/// groups of as many samples as it takes. At least `least_lags` lags. O(1).
LagSpacing spacing_of(double window_s, double period_s, int least_lags = 2, int most_lags = 20);

/// Samples in the window of the estimator, less the newest.
inline int dense_lags(const LagSpacing& spacing) { return (spacing.lags + 1) * spacing.every - 1; }

/// `data` as training with the spacing sees it: the means of the last `every` positions at each sample, in
/// `every` interleaved sequences, each with the period `every` times as long, one after the other. Rows thus
/// are not in the order of time. The first `every` - 1 samples after a gap are left out. Velocities and
/// accelerations are left out. `data` itself for `every` = 1.
TrainingData spaced_data(const TrainingData& data, int every);

/// The rows k x (M+1) of spaced positions as rows over single samples: k x N(M+1), each entry divided by N
/// and repeated N times.
Eigen::MatrixXd dense_rows(const Eigen::MatrixXd& rows, int every);

/// An input of spaced positions as the estimator computes it, over dense_lags(). An input with rows becomes
/// DFR; `input` itself for `every` = 1. Input STD has no rows and must have `every` = 1.
InputModel dense_input(InputModel input, int every);

} // namespace dfdyn::tools
