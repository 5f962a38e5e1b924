// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/identification/fit_parameters.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/robot/regressor.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <vector>

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

/// Returns R (b + 1 x b + 1, upper triangular) of the QR decomposition of the rows [columns, error] of each
/// output. `independent`: the b columns of the regressor. The rows are added in blocks, whose copies fit into
/// a cache.
std::vector<Eigen::MatrixXd> output_factors(const FitData& data, const std::vector<Eigen::Index>& independent,
                                            const Eigen::MatrixXd& error) {
    constexpr Eigen::Index block_samples = 500;
    const Eigen::Index outputs = error.cols();
    const auto count = std::ssize(independent);
    std::vector<Eigen::MatrixXd> factors(static_cast<std::size_t>(outputs),
                                         Eigen::MatrixXd::Zero(count + 1, count + 1));
    for (Eigen::Index first = 0; first < error.rows(); first += block_samples) {
        const Eigen::Index samples = std::min(block_samples, error.rows() - first);
        Eigen::MatrixXd rows(count + 1 + samples, count + 1);
        for (Eigen::Index k = 0; k < outputs; ++k) {
            Eigen::MatrixXd& factor = factors[static_cast<std::size_t>(k)];
            rows.topRows(count + 1) = factor;
            rows.bottomLeftCorner(samples, count) =
                data.regressor(Eigen::seqN(first * outputs + k, samples, outputs), independent);
            rows.col(count).tail(samples) = error.col(k).segment(first, samples);
            factor = triangular_factor(rows);
        }
    }
    return factors;
}

/// Returns R of the QR decomposition of all outputs' rows, each multiplied by the weight of its output.
/// `factors`: the output_factors().
Eigen::MatrixXd weighted_factor(const std::vector<Eigen::MatrixXd>& factors, const Eigen::VectorXd& weight) {
    const Eigen::Index size = factors.front().rows();
    Eigen::MatrixXd rows(weight.size() * size, size);
    for (Eigen::Index k = 0; k < weight.size(); ++k) {
        rows.middleRows(k * size, size) = weight[k] * factors[static_cast<std::size_t>(k)];
    }
    return triangular_factor(rows);
}

struct Solution {
    Eigen::VectorXd change, deviation;
    double condition = 0;
};

/// Returns the smallest change of the independent parameters that minimizes the residual of the error, and
/// its standard deviations. `factors`: the output_factors().
Solution solve(const std::vector<Eigen::MatrixXd>& factors, const FitNoise& noise) {
    const Eigen::VectorXd weight = noise.deviation.cwiseInverse();
    const Eigen::MatrixXd factor = weighted_factor(factors, weight);
    const Eigen::Index count = factor.cols() - 1;
    Eigen::MatrixXd scaled = factor.topLeftCorner(count, count);
    Eigen::VectorXd length = scaled.colwise().norm();
    length = (length.array() > 0).select(length, 1.0);
    scaled *= length.cwiseInverse().asDiagonal();
    const auto [u, s, v] = singular_values(scaled);
    const Eigen::VectorXd inverse = (s.array() > not_excited * s[0]).select(s.cwiseInverse(), 0.0);
    const Eigen::MatrixXd spread = v * inverse.asDiagonal();
    Solution solution;
    solution.condition = s[0] / s[s.size() - 1];
    solution.change = (spread * (u.transpose() * factor.col(count).head(count))).cwiseQuotient(length);
    // The covariance includes the correlation of each output's noise: (A⁺) diag(correlation) (A⁺)ᵀ. A factor
    // of the correlated rows replaces A, and A⁺ = spread spreadᵀ Aᵀ.
    const Eigen::VectorXd root = weight.cwiseProduct(noise.correlation_length.cwiseSqrt());
    const Eigen::MatrixXd correlated =
        weighted_factor(factors, root).topLeftCorner(count, count) * length.cwiseInverse().asDiagonal();
    const Eigen::MatrixXd middle = correlated * spread * spread.transpose();
    solution.deviation = middle.colwise().norm().transpose().cwiseQuotient(length);
    for (Eigen::Index i = 0; i < s.size(); ++i) {
        for (Eigen::Index j = 0; inverse[i] == 0 && j < count; ++j) {
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
    const Eigen::MatrixXd error = errors(data, data.nominal);
    const FitNoise unweighted{Eigen::VectorXd::Ones(error.cols()), Eigen::VectorXd::Ones(error.cols())};
    const std::vector<Eigen::MatrixXd> factors = output_factors(data, base.independent, error);
    const Solution first = solve(factors, unweighted);
    BaseFit fit;
    fit.noise = noise_of(errors(data, changed(data, base, first.change)));
    const Solution solution = solve(factors, fit.noise);
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
