// SPDX-License-Identifier: Apache-2.0
#include "tools/training/start_state.hpp"

#include "tools/common/error.hpp"
#include "tools/common/number.hpp"
#include "tools/training/covariance_factor.hpp"
#include "tools/training/input_map.hpp"
#include "tools/training/random_features.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double prior_weight_least = 1e-6;
constexpr std::size_t block_rows = 256;

/// Lambda w = b, accumulated.
struct NormalEquations {
    MatrixXd information;     // Lambda, lower triangle, 2d x 2d
    MatrixXd right_hand_side; // b, 2d x m
};

/// (y - offset) / noise_std of the given rows.
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

/// Ages the equations by the rows' number and adds the rows, the last of them with weight 1.
void fold_in(const TrainedModel& model, const TrainingData& data, const RowList& rows,
             NormalEquations& equations) {
    const auto count = static_cast<Index>(rows.size());
    const VectorXd ages = VectorXd::LinSpaced(count, static_cast<double>(count - 1), 0);
    const VectorXd roots = (ages * (std::log(model.forgetting_factor) / 2)).array().exp();
    const MatrixXd features =
        roots.asDiagonal() * random_features(model.features, stored_inputs(model.input, data, rows));
    const MatrixXd outputs = roots.asDiagonal() * scaled_outputs(model.outputs, data.outputs, rows);
    const double ageing = std::pow(model.forgetting_factor, static_cast<double>(count));
    equations.information *= ageing;
    equations.right_hand_side *= ageing;
    equations.information.selfadjointView<Eigen::Lower>().rankUpdate(features.transpose());
    equations.right_hand_side.noalias() += features.transpose() * outputs;
}

NormalEquations normal_equations(const TrainedModel& model, const TrainingData& data, const RowList& rows) {
    const Index size = 2 * static_cast<Index>(model.features.count);
    NormalEquations equations{MatrixXd::Zero(size, size), MatrixXd::Zero(size, data.outputs.cols())};
    for (std::size_t first = 0; first < rows.size(); first += block_rows) {
        const std::size_t last = std::min(first + block_rows, rows.size());
        fold_in(model, data,
                {rows.begin() + static_cast<std::ptrdiff_t>(first),
                 rows.begin() + static_cast<std::ptrdiff_t>(last)},
                equations);
    }
    const double prior_weight =
        std::max(prior_weight_least, std::pow(model.forgetting_factor, static_cast<double>(rows.size()) - 1));
    equations.information.diagonal().array() += prior_weight / model.outputs.prior_variance;
    return equations;
}

/// Lambda = L L', so Lambda^-1 = L^-T L^-1 = U D U' with U D^(1/2) = L^-T.
void store_factor(const CovarianceFactor& factor, StartModel& start) {
    const Index size = factor.lower().rows();
    const MatrixXd inverse =
        factor.lower().triangularView<Eigen::Lower>().transpose().solve(MatrixXd::Identity(size, size));
    for (Index column = 0; column < size; ++column) {
        const double root = inverse(column, column);
        start.diagonal.push_back(root * root);
        for (Index row = 0; row < column; ++row) {
            start.unit_upper.push_back(inverse(row, column) / root);
        }
    }
}

} // namespace

StartModel batch_start(const TrainedModel& model, const TrainingData& data, const RowList& rows) {
    const NormalEquations equations = normal_equations(model, data, rows);
    const auto factor = CovarianceFactor::of(equations.information);
    if (!factor) {
        throw InputError(
            "training: the information matrix of the start state is not positive definite, expected a "
            "regular one (prior variance " +
            number_text(model.outputs.prior_variance) + ")");
    }
    const MatrixXd weights = factor->solve(equations.right_hand_side);
    StartModel start;
    start.weights.assign(weights.data(), weights.data() + weights.size());
    store_factor(*factor, start);
    return start;
}

} // namespace dfdyn::tools
