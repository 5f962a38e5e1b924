// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Normal equations of one recording for p parameters of a linear model, in units of its own noise: the
/// inverse of `information` is the covariance of its estimate.
struct RecordingInformation {
    Eigen::MatrixXd information; ///< p x p
    Eigen::VectorXd moment;      ///< p
};

/// Prior of p parameters, before the recordings.
struct PooledPrior {
    Eigen::MatrixXd covariance; ///< p x p, of the common value, whose prior mean is 0
    /// p: expected standard deviation between recordings, as a share of the parameter `spread_of`; and its
    /// minimum.
    Eigen::VectorXd relative_spread, least_spread;
    std::vector<Eigen::Index> spread_of; ///< p: number of a parameter
    /// p: group number; parameters of a group have the same ratio of spread to expected spread.
    std::vector<Eigen::Index> group;
    /// p x p per recording: covariance of its differences in addition to the spread; empty: none.
    std::vector<Eigen::MatrixXd> changed;
};

/// Parameters of several recordings of one arm.
struct PooledFit {
    Eigen::VectorXd value;                   ///< p: common to the recordings
    Eigen::MatrixXd covariance;              ///< p x p, of the common value
    Eigen::VectorXd spread;                  ///< p: standard deviation between recordings
    Eigen::VectorXd ratio;                   ///< per group: spread divided by the expected spread
    std::vector<Eigen::VectorXd> difference; ///< p per recording: its own value minus the common one
    std::vector<Eigen::MatrixXd> difference_covariance; ///< p x p per recording
    std::vector<Eigen::VectorXd> own_deviation; ///< p per recording: standard deviation of its own value
    double evidence = 0; ///< log-evidence, up to a constant that depends on the recordings alone
};

/// Fits the random-effects model: in recording r the parameters are value + d_r, where d_r is normal with the
/// spread of each parameter (N. Laird and J. Ware, 1982). The spread is the mode of its posterior, found by
/// expectation maximisation. Its inverse chi-squared prior at the expected spread has the weight of three
/// recordings of one parameter. `start`: ratios of a similar fit, or empty. Throws std::logic_error without
/// recordings. Cost: O(p³) per recording and iteration (5 to 60).
PooledFit pool(const std::vector<RecordingInformation>& recordings, const PooledPrior& prior,
               const Eigen::VectorXd& start = {});

} // namespace dfdyn::tools
