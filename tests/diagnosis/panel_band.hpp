// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tests {

/// Each column below 5 Hz: a second-order Butterworth low pass forwards and backwards, hence without lag. At
/// most six columns.
Eigen::MatrixXd in_band(const Eigen::MatrixXd& rows, double rate_hz);

/// Root mean square of each column below 5 Hz, half a second at both ends left out.
Eigen::VectorXd band_rms(const Eigen::MatrixXd& rows, double rate_hz);

/// Logarithm of the likelihood ratio between noise with a known course in it and noise alone, both in band,
/// where the noise is Gaussian with the spectrum that these rows of it have. T x m each.
double band_evidence(const Eigen::MatrixXd& course, const Eigen::MatrixXd& noise, double rate_hz);

} // namespace dfdyn::tests
