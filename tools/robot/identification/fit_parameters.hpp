// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/identification/base_parameters.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// What a fit takes: T samples of m outputs, and their stacked regressor.
struct FitData {
    Eigen::MatrixXd regressor; ///< T m x p, rows t m + k
    Eigen::MatrixXd outputs;   ///< T x m
    Eigen::VectorXd nominal;   ///< p parameters, in the regressor's units
};

/// How well each output is known: the fit weighs it by 1/deviation².
struct FitNoise {
    Eigen::VectorXd deviation; ///< of what the fit leaves, per output
    /// How many neighbouring samples tell as much as one independent one: (1 + ρ)/(1 − ρ) for the lag-one
    /// correlation ρ of what the fit leaves, at least 1.
    Eigen::VectorXd correlation_length;
};

/// Ordinary least squares of the base parameters, and how well this recording determines them.
struct BaseFit {
    Eigen::VectorXd value;
    Eigen::VectorXd nominal;
    Eigen::VectorXd
        deviation; ///< standard deviation, correlation of the noise counted; infinite: not excited
    std::vector<bool> determined; ///< deviation at most a third of the larger of |value| and |nominal|
    double condition =
        0; ///< of the weighted regressor of the base parameters, its columns of the same length
    Eigen::VectorXd parameters; ///< all p: the nominal ones, changed where the base parameters change
    FitNoise noise;
};

/// Least squares of the base parameters, outputs weighed by what an unweighted fit leaves of each. Where the
/// recording excites nothing the parameters stay nominal.
BaseFit fit_base_parameters(const FitData& data, const BaseParameters& base);

/// Parameters of bodies that can be (10 each, log-Cholesky coordinates), by Levenberg and Marquardt: least
/// squares weighed as `noise` says, drawn weakly towards the nominal ones (masses and sizes within a factor
/// e, centres of mass within a body's size), which settles what the recording does not determine. Nominal
/// bodies that cannot be are replaced by near ones that can.
Eigen::VectorXd fit_consistent_parameters(const FitData& data, const FitNoise& noise);

/// Root mean square of outputs − regressor · parameters, per output.
Eigen::VectorXd rms_error(const FitData& data, const Eigen::VectorXd& parameters);

} // namespace dfdyn::tools
