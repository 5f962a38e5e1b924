// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tests {

/// Filters each column with a second-order Butterworth low pass at 5 Hz, forwards and backwards and hence
/// without lag. At most six columns.
Eigen::MatrixXd in_band(const Eigen::MatrixXd& rows, double rate_hz);

/// Root mean square of each column below 5 Hz, without half a second at both ends.
Eigen::VectorXd band_rms(const Eigen::MatrixXd& rows, double rate_hz);

/// Logarithm of the likelihood ratio between noise plus a known signal and noise alone, both below 5 Hz. The
/// noise is Gaussian and has the spectrum of `noise`. Both matrices are T x m.
double band_evidence(const Eigen::MatrixXd& course, const Eigen::MatrixXd& noise, double rate_hz);

} // namespace dfdyn::tests
