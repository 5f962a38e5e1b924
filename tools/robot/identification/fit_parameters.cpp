// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/identification/fit_parameters.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/robot/regressor.hpp"

#include <Eigen/Core>

#include <cmath>
#include <limits>

namespace dfdyn::tools {

namespace {

/// relative limit of singular values; smaller ones are directions without information
constexpr double not_excited = 1e-10;
constexpr double negligible = 1e-6; ///< part of a unit vector

Eigen::MatrixXd errors(const FitData& data, const Eigen::VectorXd& parameters) {
    return data.outputs - unstacked(data.regressor * parameters, data.outputs.cols());
}

FitNoise noise_of(const Eigen::MatrixXd& left) {
    const Eigen::Index rows = left.rows();
    FitNoise noise{left.colwise().norm().transpose() / std::sqrt(static_cast<double>(rows)),
                   Eigen::VectorXd::Ones(left.cols())};
    // avoids an infinite weight for an exact fit
    const double least = std::max(1e-9 * noise.deviation.maxCoeff(), 1e-15);
    noise.deviation = noise.deviation.cwiseMax(least);
    for (Eigen::Index k = 0; k < left.cols(); ++k) {
        const double power = left.col(k).squaredNorm();
        const double product = left.col(k).head(rows - 1).dot(left.col(k).tail(rows - 1));
        const double correlation = power > 0 ? std::min(product / power, 0.999) : 0;
        noise.correlation_length[k] = std::max(1.0, (1 + correlation) / (1 - correlation));
    }
    return noise;
}

/// Returns the weight of every stacked row.
Eigen::VectorXd row_weights(const Eigen::VectorXd& per_output, Eigen::Index rows) {
    return per_output.replicate(rows, 1);
}

struct Solution {
    Eigen::VectorXd change, deviation;
    double condition = 0;
};

/// Returns the smallest change that minimizes the residual of `error`, and its standard deviations.
Solution solve(const Eigen::MatrixXd& columns, const Eigen::VectorXd& error, const FitNoise& noise) {
    const Eigen::Index samples = columns.rows() / noise.deviation.size();
    const Eigen::VectorXd weight = row_weights(noise.deviation.cwiseInverse(), samples);
    Eigen::MatrixXd weighted = weight.asDiagonal() * columns;
    Eigen::VectorXd length = weighted.colwise().norm();
    length = (length.array() > 0).select(length, 1.0);
    weighted *= length.cwiseInverse().asDiagonal();
    if (weighted.rows() < weighted.cols()) { // the directions without an equation are part of `v` then, too
        weighted.conservativeResizeLike(Eigen::MatrixXd::Zero(weighted.cols(), weighted.cols()));
    }
    const auto [padded, s, v] = singular_values(weighted);
    const auto u = padded.topRows(columns.rows());
    const Eigen::VectorXd inverse = (s.array() > not_excited * s[0]).select(s.cwiseInverse(), 0.0);
    const Eigen::MatrixXd spread = v * inverse.asDiagonal();
    Solution solution;
    solution.condition = s[0] / s[s.size() - 1];
    solution.change = (spread * (u.transpose() * weight.cwiseProduct(error))).cwiseQuotient(length);
    // The covariance includes the correlation of each output's noise: (A⁺) diag(correlation) (A⁺)ᵀ.
    const Eigen::VectorXd root = row_weights(noise.correlation_length.cwiseSqrt(), samples);
    const Eigen::MatrixXd middle = root.asDiagonal() * u * spread.transpose();
    solution.deviation = middle.colwise().norm().transpose().cwiseQuotient(length);
    for (Eigen::Index i = 0; i < s.size(); ++i) {
        for (Eigen::Index j = 0; inverse[i] == 0 && j < columns.cols(); ++j) {
            if (std::abs(v(j, i)) > negligible) {
                solution.deviation[j] = std::numeric_limits<double>::infinity();
            }
        }
    }
    return solution;
}

/// Returns all parameters after a change of the independent ones.
Eigen::VectorXd changed(const FitData& data, const BaseParameters& base, const Eigen::VectorXd& change) {
    Eigen::VectorXd parameters = data.nominal;
    parameters(base.independent) += change;
    return parameters;
}

} // namespace

BaseFit fit_base_parameters(const FitData& data, const BaseParameters& base) {
    const Eigen::MatrixXd columns = data.regressor(Eigen::all, base.independent);
    const Eigen::MatrixXd error = errors(data, data.nominal);
    const Eigen::VectorXd stacked_error = stacked(error);
    const FitNoise unweighted{Eigen::VectorXd::Ones(error.cols()), Eigen::VectorXd::Ones(error.cols())};
    const Solution first = solve(columns, stacked_error, unweighted);
    BaseFit fit;
    fit.noise = noise_of(errors(data, changed(data, base, first.change)));
    const Solution solution = solve(columns, stacked_error, fit.noise);
    fit.nominal = base.combination * data.nominal;
    fit.value = fit.nominal + solution.change;
    fit.deviation = solution.deviation;
    fit.condition = solution.condition;
    fit.parameters = changed(data, base, solution.change);
    for (Eigen::Index i = 0; i < fit.value.size(); ++i) {
        fit.determined.push_back(3 * fit.deviation[i] <=
                                 std::max(std::abs(fit.value[i]), std::abs(fit.nominal[i])));
    }
    return fit;
}

Eigen::VectorXd rms_error(const FitData& data, const Eigen::VectorXd& parameters) {
    return errors(data, parameters).colwise().norm().transpose() /
           std::sqrt(static_cast<double>(data.outputs.rows()));
}

} // namespace dfdyn::tools
