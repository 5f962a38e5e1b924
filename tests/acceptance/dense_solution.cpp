// SPDX-License-Identifier: Apache-2.0
#include "tests/acceptance/dense_solution.hpp"

#include "tools/training/data/input_map.hpp"
#include "tools/training/data/motion.hpp"
#include "tools/training/likelihood/random_features.hpp"
#include "tools/training/physics/physics_columns.hpp"
#include "tools/training/physics/robot_regressor.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace dfdyn::tests {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd to_eigen(const std::vector<double>& values) {
    return Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
}

/// psi of the selected parameters in units of scale and noise, rows x m p.
MatrixXd physics_columns(const tools::TrainedModel& model, const tools::TrainingData& data,
                         const tools::RowList& rows) {
    const tools::PhysicsModel& physics = *model.physics;
    const MatrixXd xi = tools::stored_inputs(physics.motion, data, rows);
    const auto part = [&xi](Index first) {
        return MatrixXd(xi(Eigen::all, Eigen::seq(first, Eigen::last, 3)));
    };
    const auto regressor = tools::robot_regressor(physics.chain, physics.effects, physics.output_gain);
    const MatrixXd all = tools::all_columns(*regressor, {part(0), part(1), part(2)});
    const auto selected = static_cast<Index>(physics.selected.size());
    MatrixXd columns(all.rows(), data.outputs.cols() * selected);
    for (Index k = 0; k < data.outputs.cols(); ++k) {
        for (Index c = 0; c < selected; ++c) {
            const auto element = static_cast<std::size_t>(c);
            columns.col(k * selected + c) =
                all.col(k * regressor->columns() + physics.selected[element]) *
                (physics.column_scale[element] / model.outputs.noise_std[static_cast<std::size_t>(k)]);
        }
    }
    return columns;
}

} // namespace

DenseRegression::DenseRegression(const tools::TrainedModel& model, const tools::TrainingData& data)
    : weight_variance_(model.outputs.prior_variance) {
    const tools::RowList usable = tools::usable_rows(
        data.gap_before, std::max(model.input.lags, model.physics ? model.physics->motion.lags : 0));
    const Index samples = data.outputs.rows();
    const Index outputs = data.outputs.cols();
    const VectorXd noise = to_eigen(model.outputs.noise_std);
    targets_ = (data.outputs.rowwise() - to_eigen(model.outputs.offset).transpose()) *
               noise.cwiseInverse().asDiagonal();
    means_ = MatrixXd::Zero(samples, outputs);
    features_ = MatrixXd::Zero(samples, 2L * model.features.count);
    if (model.features.count > 0) {
        features_(usable, Eigen::all) =
            tools::random_features(model.features, tools::stored_inputs(model.input, data, usable));
    }
    if (!model.physics) {
        return;
    }
    const MatrixXd columns = physics_columns(model, data, usable);
    const Index selected = columns.cols() / outputs;
    if (model.physics->prior_variance == 0) {
        for (Index k = 0; k < outputs; ++k) {
            means_(usable, k) =
                columns.middleCols(k * selected, selected) * to_eigen(model.physics->start.weights);
        }
        return;
    }
    parameters_ = selected;
    parameter_variance_ = model.physics->prior_variance;
    physics_ = MatrixXd::Zero(samples, columns.cols());
    physics_(usable, Eigen::all) = columns;
}

VectorXd DenseRegression::unknowns_row(Index row, Index k) const {
    VectorXd result = VectorXd::Zero(unknowns());
    result.segment(k * features_.cols(), features_.cols()) = features_.row(row);
    if (parameters_ > 0) {
        result.tail(parameters_) = physics_.row(row).segment(k * parameters_, parameters_);
    }
    return result;
}

VectorXd DenseRegression::prior_deviation() const {
    VectorXd result = VectorXd::Constant(unknowns(), std::sqrt(weight_variance_));
    result.tail(parameters_).setConstant(std::sqrt(parameter_variance_));
    return result;
}

VectorXd DenseRegression::start_of(const tools::TrainedModel& model) const {
    VectorXd result = VectorXd::Zero(unknowns());
    const VectorXd weights = to_eigen(model.start.weights);
    result.head(weights.size()) = weights;
    if (parameters_ > 0) {
        const VectorXd parameters = to_eigen(model.physics->start.weights);
        result.tail(parameters_) = parameters;
        const Eigen::Map<const MatrixXd> coupling(model.physics->coupling.data(), features_.cols(),
                                                  features_.cols() > 0 ? outputs() * parameters_ : 0);
        for (Index k = 0; k < outputs() && features_.cols() > 0; ++k) {
            result.segment(k * features_.cols(), features_.cols()) -=
                coupling.middleCols(k * parameters_, parameters_) * parameters;
        }
    }
    return result;
}

double DenseRegression::predicted_by_start(const tools::TrainedModel& model, Index row, Index k) const {
    return unknowns_row(row, k).dot(start_of(model)) + mean(row, k);
}

DenseSolution::DenseSolution(const DenseRegression& regression, const tools::RowList& rows)
    : regression_(&regression) {
    const Index unknowns = regression.unknowns();
    const auto equations = static_cast<Index>(rows.size()) * regression.outputs();
    MatrixXd system = MatrixXd::Zero(equations + unknowns, unknowns + 1);
    Index equation = 0;
    for (const Index row : rows) {
        for (Index k = 0; k < regression.outputs(); ++k, ++equation) {
            system.row(equation).head(unknowns) = regression.unknowns_row(row, k);
            system(equation, unknowns) = regression.target(row, k) - regression.mean(row, k);
        }
    }
    system.bottomLeftCorner(unknowns, unknowns).diagonal() = regression.prior_deviation().cwiseInverse();
    const MatrixXd triangle =
        Eigen::HouseholderQR<MatrixXd>(system).matrixQR().topRows(unknowns).triangularView<Eigen::Upper>();
    root_ = triangle.leftCols(unknowns);
    solution_ = root_.triangularView<Eigen::Upper>().solve(triangle.col(unknowns));
}

double DenseSolution::prediction(Index row, Index k) const {
    return regression_->unknowns_row(row, k).dot(solution_) + regression_->mean(row, k);
}

double DenseSolution::standard_deviation(Index row, Index k) const {
    const VectorXd root =
        root_.transpose().triangularView<Eigen::Lower>().solve(regression_->unknowns_row(row, k));
    return std::sqrt(1 + root.squaredNorm());
}

} // namespace dfdyn::tests
