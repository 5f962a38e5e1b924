// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/data/training_data.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

/// Positions in a lag window: `lags` + 1 positions, `every` samples apart. With `every` > 1, each is the mean
/// of `every` samples, which removes motion and noise above the Nyquist frequency of the spacing. The
/// estimator still predicts and learns in every tick: its rows are constant over each group of samples (see
/// dense_input()). Memory and multiply-adds therefore grow with the number of samples in the window, but only
/// `lags` + 1 numbers per row are learned.
struct LagSpacing {
    int lags = 10; ///< M >= 1
    int every = 1; ///< N >= 1
};

/// Least number of lags of a window that is given in seconds.
inline constexpr int least_window_lags = 2;
/// Largest number of lags of such a window, if groups of samples are permitted.
inline constexpr int most_spaced_lags = 20;

/// Returns the spacing for a window of `window_s` at this sample period: every sample up to `most_lags` lags,
/// otherwise groups of samples. At least least_window_lags lags. O(1).
LagSpacing spacing_of(double window_s, double period_s, int most_lags = most_spaced_lags);

/// Number of samples in the estimator's window, without the newest.
inline int dense_lags(const LagSpacing& spacing) { return (spacing.lags + 1) * spacing.every - 1; }

/// Returns `data` for training with the spacing: the means of the last `every` positions at each sample, as
/// `every` interleaved sequences with `every` times the period, one after the other. The rows are therefore
/// not in chronological order; `time_order` has their samples. The first `every` - 1 samples after a gap,
/// velocities and accelerations are left out. Returns `data` itself for `every` = 1.
TrainingData spaced_data(const TrainingData& data, int every);

/// Converts the rows k x (M+1) for spaced positions to rows for single samples: k x N(M+1), each entry
/// divided by N and repeated N times.
Eigen::MatrixXd dense_rows(const Eigen::MatrixXd& rows, int every);

/// Returns an input of spaced positions in the form that the estimator computes, over dense_lags(). An input
/// with rows becomes DFR. Returns `input` itself for `every` = 1. Input STD has no rows and requires `every`
/// = 1.
InputModel dense_input(InputModel input, int every);

} // namespace dfdyn::tools
