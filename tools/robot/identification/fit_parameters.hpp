// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/identification/base_parameters.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Input of a fit: T samples of m outputs, and their stacked regressor.
struct FitData {
    Eigen::MatrixXd regressor; ///< T m x p, rows t m + k
    Eigen::MatrixXd outputs;   ///< T x m
    Eigen::VectorXd nominal;   ///< p parameters, in the regressor's units
};

/// Noise of each output: the fit has weights 1/deviation².
struct FitNoise {
    Eigen::VectorXd deviation; ///< of the fit's residual, per output
    /// Number of neighbouring samples with the information of one independent sample: (1 + ρ)/(1 − ρ) for the
    /// residual's lag-one correlation ρ, at least 1.
    Eigen::VectorXd correlation_length;
};

/// Ordinary least-squares estimate of the base parameters, and its uncertainty for this recording.
struct BaseFit {
    Eigen::VectorXd value;
    Eigen::VectorXd nominal;
    Eigen::VectorXd
        deviation; ///< standard deviation, including the correlation of the noise; infinite: not excited
    std::vector<bool> determined; ///< deviation at most a third of the larger of |value| and |nominal|
    double condition = 0; ///< of the weighted regressor of the base parameters, with columns of equal length
    Eigen::VectorXd parameters; ///< all p: the nominal ones, plus the changes of the base parameters
    FitNoise noise;
};

/// Fits the base parameters by least squares, with weights from the outputs' residuals in an unweighted fit.
/// Parameters that the recording does not excite remain nominal. Needs little memory beyond `data`. Cost:
/// O(T m b²) for b base parameters.
BaseFit fit_base_parameters(const FitData& data, const BaseParameters& base);

/// Returns physically consistent parameters of the bodies (10 each, in log-Cholesky coordinates), by the
/// Levenberg-Marquardt method: least squares with the weights of `noise`, weakly regularized towards the
/// nominal ones (masses and sizes within a factor e, centres of mass within a body's size). The
/// regularization determines what the recording does not. Inconsistent nominal bodies are replaced by similar
/// consistent ones.
Eigen::VectorXd fit_consistent_parameters(const FitData& data, const FitNoise& noise);

/// Returns the root mean square of outputs − regressor · parameters, per output.
Eigen::VectorXd rms_error(const FitData& data, const Eigen::VectorXd& parameters);

} // namespace dfdyn::tools
