// SPDX-License-Identifier: Apache-2.0
#include "tools/training/search/hold_out.hpp"

#include "tools/training/likelihood/covariance_factor.hpp"
#include "tools/training/likelihood/gaussian_kernel.hpp"
#include "tools/training/likelihood/physics_likelihood.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kernel_grid_side = 13;
static_assert(kernel_grid_side * kernel_grid_side == kernel_grid_points);
constexpr double no_error = std::numeric_limits<double>::infinity();

/// Returns first, first * factor, …: `count` values.
std::vector<double> geometric(double first, double factor, int count) {
    std::vector<double> values;
    for (int i = 0; i < count; ++i) {
        values.push_back(first * std::pow(factor, i));
    }
    return values;
}

double relative_error(const MatrixXd& predicted, const MatrixXd& measured) {
    const MatrixXd centred = measured.rowwise() - measured.colwise().mean();
    const Eigen::ArrayXd spread = centred.colwise().squaredNorm().transpose();
    const Eigen::ArrayXd error = (predicted - measured).colwise().squaredNorm().transpose();
    const double mean = (error / spread).mean();
    return std::isfinite(mean) ? mean : no_error;
}

double kernel_error(const MatrixXd& kernel, const MatrixXd& outputs, Index training, double noise_ratio) {
    MatrixXd covariance = kernel.topLeftCorner(training, training);
    covariance.diagonal().array() += noise_ratio;
    const auto factor = CovarianceFactor::of(std::move(covariance));
    if (!factor) {
        return no_error;
    }
    const Index held_out = kernel.rows() - training;
    const MatrixXd predicted =
        kernel.bottomLeftCorner(held_out, training) * factor->solve(outputs.topRows(training));
    return relative_error(predicted, outputs.bottomRows(held_out));
}

/// Returns Psi_k pi in column k.
MatrixXd products(const MatrixXd& columns, const VectorXd& parameters, Index outputs) {
    MatrixXd result(columns.rows(), outputs);
    for (Index k = 0; k < outputs; ++k) {
        result.col(k) = columns.middleCols(k * parameters.size(), parameters.size()) * parameters;
    }
    return result;
}

void tell(const PointCallback& done) {
    if (done) {
        done();
    }
}

} // namespace

std::vector<HoldOutPoint> hold_out_kernel(const MatrixXd& inputs, const MatrixXd& outputs, Index training,
                                          const PointCallback& done) {
    std::vector<HoldOutPoint> points;
    for (const double length_scale : geometric(0.5, std::sqrt(2.0), kernel_grid_side)) {
        const MatrixXd kernel = gaussian_kernel(inputs, length_scale);
        for (const double noise_ratio : geometric(1e-6, std::sqrt(10.0), kernel_grid_side)) {
            points.push_back(
                {length_scale, noise_ratio, 0, kernel_error(kernel, outputs, training, noise_ratio)});
            tell(done);
        }
    }
    return points;
}

std::optional<std::vector<HoldOutPoint>> hold_out_physics(const MatrixXd& columns, const MatrixXd& outputs,
                                                          Index training, const PointCallback& done) {
    const MatrixXd psi = columns.topRows(training);
    const MatrixXd y = outputs.topRows(training);
    const LinearStatistics statistics = linear_statistics(y, psi, y, psi);
    const auto least_squares = best_variances(statistics, PhysicsPrior::none);
    if (!least_squares) {
        return std::nullopt;
    }
    double energy = 0; // of the columns, relative to the outputs'
    for (Index k = 0; k < y.cols(); ++k) {
        energy += psi.middleCols(k * statistics.products.rows(), statistics.products.rows()).squaredNorm() /
                  y.col(k).squaredNorm();
    }
    VectorXd x(y.cols() + 1);
    x.head(y.cols()) = least_squares->output_variance.array().log();
    std::vector<HoldOutPoint> points;
    for (const double factor : geometric(1e-6, std::sqrt(10.0), physics_grid_points)) {
        const double prior_variance = factor * static_cast<double>(y.cols()) / energy;
        x[y.cols()] = std::log(prior_variance);
        const auto at = variance_criterion(statistics, PhysicsPrior::shared, x);
        const Index held_out = outputs.rows() - training;
        points.push_back(
            {0, 0, prior_variance,
             at ? relative_error(products(columns.bottomRows(held_out), at->parameters, y.cols()),
                                 outputs.bottomRows(held_out))
                : no_error});
        tell(done);
    }
    return points;
}

const HoldOutPoint& best_point(const std::vector<HoldOutPoint>& points) {
    return *std::min_element(points.begin(), points.end(),
                             [](const HoldOutPoint& a, const HoldOutPoint& b) { return a.error < b.error; });
}

bool at_edge(const HoldOutPoint& best, const std::vector<HoldOutPoint>& points) {
    constexpr std::array coordinates{&HoldOutPoint::length_scale, &HoldOutPoint::noise_ratio,
                                     &HoldOutPoint::prior_variance};
    return std::ranges::any_of(coordinates, [&](double HoldOutPoint::*coordinate) {
        const auto [least, largest] = std::ranges::minmax(points, {}, coordinate);
        return least.*coordinate < largest.*coordinate &&
               (best.*coordinate == least.*coordinate || best.*coordinate == largest.*coordinate);
    });
}

} // namespace dfdyn::tools
