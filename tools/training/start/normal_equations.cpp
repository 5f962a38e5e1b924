// SPDX-License-Identifier: Apache-2.0
#include "tools/training/start/normal_equations.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/training/data/input_map.hpp"
#include "tools/training/likelihood/random_features.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double prior_weight_least = 1e-6;
constexpr std::size_t rows_at_once = 256;

/// Applies forgetting for the number of rows and adds the rows, the last of them with weight 1.
void fold_in(const TrainedModel& model, const TrainingData& data, const RowList& rows,
             const MatrixXd& targets, NormalEquations& equations) {
    const auto count = static_cast<Index>(rows.size());
    const VectorXd roots = forgetting_roots(model.forgetting_factor, count);
    const MatrixXd features =
        roots.asDiagonal() * random_features(model.features, stored_inputs(model.input, data, rows));
    const MatrixXd weighted = roots.asDiagonal() * targets;
    const double ageing = std::pow(model.forgetting_factor, static_cast<double>(count));
    equations.information *= ageing;
    equations.right_hand_side *= ageing;
    equations.information.selfadjointView<Eigen::Lower>().rankUpdate(features.transpose());
    equations.right_hand_side.noalias() += features.transpose() * weighted;
}

} // namespace

NormalEquations normal_equations(const TrainedModel& model, const TrainingData& data, const RowList& rows,
                                 const MatrixXd& targets) {
    const Index size = 2 * static_cast<Index>(model.features.count);
    NormalEquations equations{MatrixXd::Zero(size, size), MatrixXd::Zero(size, targets.cols())};
    for (std::size_t first = 0; first < rows.size(); first += rows_at_once) {
        const std::size_t last = std::min(first + rows_at_once, rows.size());
        fold_in(model, data,
                {rows.begin() + static_cast<std::ptrdiff_t>(first),
                 rows.begin() + static_cast<std::ptrdiff_t>(last)},
                targets.middleRows(static_cast<Index>(first), static_cast<Index>(last - first)), equations);
    }
    return equations;
}

VectorXd forgetting_roots(double forgetting_factor, Index count) {
    const VectorXd ages = VectorXd::LinSpaced(count, static_cast<double>(count - 1), 0);
    return (ages * (std::log(forgetting_factor) / 2)).array().exp();
}

double prior_weight(double forgetting_factor, Index count) {
    return std::max(prior_weight_least, std::pow(forgetting_factor, static_cast<double>(count) - 1));
}

MatrixXd scaled_outputs(const OutputModel& model, const MatrixXd& outputs, const RowList& rows) {
    const auto count = static_cast<Index>(model.offset.size());
    const Eigen::Map<const VectorXd> offset(model.offset.data(), count);
    const Eigen::Map<const VectorXd> noise_std(model.noise_std.data(), count);
    MatrixXd scaled(static_cast<Index>(rows.size()), count);
    for (Index t = 0; t < scaled.rows(); ++t) {
        scaled.row(t) = (outputs.row(rows[static_cast<std::size_t>(t)]).transpose() - offset)
                            .cwiseQuotient(noise_std)
                            .transpose();
    }
    return scaled;
}

CovarianceFactor information_factor(MatrixXd information, double prior_variance) {
    auto factor = CovarianceFactor::of(std::move(information));
    if (!factor) {
        throw InputError("training: the initial state cannot be computed: expected a positive definite "
                         "information matrix, found another (prior variance " +
                         number_text(prior_variance) +
                         "); use fewer features or a longer memory, or record more motion");
    }
    return *std::move(factor);
}

void store_inverse(const CovarianceFactor& factor, std::vector<double>& unit_upper,
                   std::vector<double>& diagonal) {
    const Index size = factor.lower().rows();
    const MatrixXd inverse =
        factor.lower().triangularView<Eigen::Lower>().transpose().solve(MatrixXd::Identity(size, size));
    for (Index column = 0; column < size; ++column) {
        const double root = inverse(column, column);
        diagonal.push_back(root * root);
        for (Index row = 0; row < column; ++row) {
            unit_upper.push_back(inverse(row, column) / root);
        }
    }
}

void store_covariance(const Eigen::MatrixXd& covariance, std::vector<double>& unit_upper,
                      std::vector<double>& diagonal) {
    const std::optional<CovarianceFactor> factor = CovarianceFactor::of(covariance);
    if (!factor) {
        throw InputError("extended model: the initial state cannot be computed: expected a positive definite "
                         "covariance of the parameters, found another; check the masses and inertias of the "
                         "robot's file");
    }
    store_inverse(information_factor(factor->inverse(), 1), unit_upper, diagonal);
}

} // namespace dfdyn::tools
