// SPDX-License-Identifier: Apache-2.0
#include "tools/training/search/training_setup.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/model/inputs/input_description.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int rows_least = 20;
constexpr Index structured_betas = 2; // index of the logits of DFSR's poles among its parameters

/// Returns the number and the cost of the gaps for a message; empty without gaps.
std::string gaps_text(const TrainingData& data) {
    std::size_t gaps = 0;
    std::size_t run = 0;
    std::size_t longest = 0;
    for (std::size_t row = 0; row < data.gap_before.size(); ++row) {
        const bool interleaved =
            !data.time_order.empty() && row > 0 && data.time_order[row] < data.time_order[row - 1];
        const bool gap = row > 0 && data.gap_before[row] != 0 && !interleaved;
        gaps += gap ? 1 : 0;
        run = gap ? 1 : run + 1;
        longest = std::max(longest, run);
    }
    const std::string advice =
        data.steady.rows == 0 ? ""
                              : "; one row in " + std::to_string(data.steady.rows) +
                                    " has constant steps of " + rounded_text(1e3 * data.steady.period_s) +
                                    " ms: --rows ::" + std::to_string(data.steady.rows);
    return gaps == 0 ? ""
                     : "; the time steps are not constant: " + std::to_string(gaps) +
                           " gaps at a sample period of " + rounded_text(1e3 * data.sample_period_s) +
                           " ms, at most " + std::to_string(longest) + " rows without one" + advice;
}

} // namespace

TrainingRows choose_rows(const TrainingData& data, const TrainingOptions& options) {
    TrainingRows rows;
    rows.usable = usable_rows(data.gap_before, options.lags);
    const MotionSplit split = split_by_motion(data.positions, rows.usable, options.lags);
    if (split.moving.size() < rows_least) {
        throw InputError("training data: expected at least " + std::to_string(rows_least) +
                         " rows in motion with " + std::to_string(options.lags) +
                         " rows before them without a gap, found " + std::to_string(split.moving.size()) +
                         gaps_text(data));
    }
    rows.moving = split.moving;
    rows.likelihood = likelihood_rows(split, options.likelihood_rows);
    if (!data.time_order.empty()) { // forgetting and blocks of time need the order
        std::ranges::sort(rows.usable, {},
                          [&](Index row) { return data.time_order[static_cast<std::size_t>(row)]; });
    }
    return rows;
}

TrainingSetup::TrainingSetup(const TrainingData& training_data, const TrainingOptions& training_options)
    : data(training_data), options(training_options), rows(choose_rows(data, options)),
      spread(data.positions, rows.moving, options.lags) {}

std::unique_ptr<RowFamily> TrainingSetup::row_family(InputKind kind) const {
    return input_description(kind).rows({options.lags, options.rows_per_joint, spread.pooled_factor()});
}

std::unique_ptr<InputMap> TrainingSetup::input(InputKind kind, const RowList& at) const {
    if (input_description(kind).uses_derivatives()) {
        return derivative_input(data, at, rows.moving, spread, options.relevance);
    }
    return lag_input(data.positions, at, spread, row_family(kind));
}

std::unique_ptr<MotionRows> TrainingSetup::motion_rows(InputKind kind) const {
    const double period = data.sample_period_s;
    const PhysicsMotion own = options.physics.motion;
    if (own != PhysicsMotion::of_input && !input_description(kind).uses_derivatives()) {
        const Index inputs = input(kind, {rows.moving.front()})->bounds().lower.size();
        return own == PhysicsMotion::free ? free_motion(options.lags, period, inputs)
                                          : difference_motion(options.lags, period, inputs, true);
    }
    switch (input_description(kind).motion) {
    case MotionSource::derivatives:
        return nullptr;
    case MotionSource::own_filters:
        return difference_motion(options.lags, period, structured_betas, false);
    case MotionSource::own_rows:
        return scaled_motion(row_family(kind), options.lags, period, spread.pooled_factor());
    default:
        return polynomial_motion(options.lags, period);
    }
}

std::unique_ptr<LearnedMotion> TrainingSetup::motion(InputKind kind, const RowList& at) const {
    std::unique_ptr<MotionRows> own = motion_rows(kind);
    return own == nullptr ? given_motion(data, at)
                          : lag_motion(data.positions, at, options.lags, std::move(own));
}

VectorXd TrainingSetup::motion_start(InputKind kind) const {
    const RowList any{rows.moving.front()};
    NormalSource random(options.seed);
    const VectorXd start = input(kind, any)->start(0, random);
    return concatenated(start, motion(kind, any)->start(start));
}

std::unique_ptr<PhysicsColumns> TrainingSetup::physics(InputKind kind, const RowList& at,
                                                       const ColumnChoice& choice) const {
    return std::make_unique<RegressorColumns>(*options.physics.regressor, motion(kind, at), choice);
}

VectorXd output_deviations(const TrainingSetup& setup) {
    const MatrixXd outputs = setup.outputs(setup.rows.likelihood);
    const MatrixXd centred = outputs.rowwise() - outputs.colwise().mean();
    return centred.colwise().norm().transpose() / std::sqrt(static_cast<double>(outputs.rows()));
}

VectorXd output_offset(const TrainingSetup& setup) {
    if (setup.options.model->has_physics() || !setup.options.centred) {
        return VectorXd::Zero(setup.data.outputs.cols());
    }
    return setup.outputs(setup.rows.moving).colwise().mean().transpose();
}

void check_outputs_vary(const TrainingSetup& setup) {
    const MatrixXd outputs = setup.outputs(setup.rows.likelihood);
    for (Index k = 0; k < outputs.cols(); ++k) {
        if (outputs.col(k).minCoeff() == outputs.col(k).maxCoeff()) {
            throw InputError("training data: expected outputs that vary, found " +
                             setup.data.output_names[static_cast<std::size_t>(k)] + " constant at " +
                             number_text(outputs(0, k)) + " over the rows in motion");
        }
    }
}

ColumnChoice choose_columns(const TrainingSetup& setup) {
    const Regressor& regressor = *setup.options.physics.regressor;
    const InputKind kind = setup.options.input;
    const MatrixXd columns =
        all_columns(regressor, setup.motion(kind, setup.rows.likelihood)->evaluate(setup.motion_start(kind)));
    const VectorXd deviations = output_deviations(setup);
    const Index samples = columns.rows();
    MatrixXd relative(samples * regressor.outputs(), regressor.columns());
    for (Index k = 0; k < regressor.outputs(); ++k) {
        // the search reports the error
        const double unit = std::isfinite(deviations[k]) ? deviations[k] : 1;
        relative.middleRows(k * samples, samples) =
            columns.middleCols(k * regressor.columns(), regressor.columns()) / unit;
    }
    if (!relative.allFinite()) {
        throw InputError("training: expected finite columns of the physics over the recording, found some "
                         "that are not");
    }
    const PhysicsOptions& physics = setup.options.physics;
    ColumnChoice choice = select_columns(relative, physics.column_threshold, physics.parameter_size);
    if (choice.columns.empty()) {
        throw InputError("training: expected physics that the recording excites, found " +
                         std::to_string(regressor.columns()) + " columns without effect on the outputs");
    }
    if (physics.prior == PriorForm::unit) {
        choice.scale.setOnes();
    }
    return choice;
}

} // namespace dfdyn::tools
