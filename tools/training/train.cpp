// SPDX-License-Identifier: Apache-2.0
#include "tools/training/train.hpp"

#include "tools/common/error.hpp"
#include "tools/common/number.hpp"
#include "tools/model/model_file.hpp"
#include "tools/training/feature_likelihood.hpp"
#include "tools/training/input_map.hpp"
#include "tools/training/marginal_likelihood.hpp"
#include "tools/training/multi_start.hpp"
#include "tools/training/output_likelihood.hpp"
#include "tools/training/random_features.hpp"
#include "tools/training/start_state.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int rows_least = 20;
constexpr double limit_factor = 10;

void expect(bool condition, const std::string& what, double found) {
    if (!condition) {
        throw InputError("training options: expected " + what + ", found " + number_text(found));
    }
}

void check_options(const TrainingOptions& options) {
    const int lags_least = options.input == InputKind::DFSR ? 2 : 1;
    expect(options.lags >= lags_least, "at least " + std::to_string(lags_least) + " lags", options.lags);
    if (options.input == InputKind::DFR) {
        expect(options.rows_per_joint >= 1 && options.rows_per_joint <= options.lags + 1,
               "1 to lags + 1 rows per joint", options.rows_per_joint);
    }
    expect(options.feature_count >= 1, "at least 1 random feature", options.feature_count);
    expect(options.likelihood_rows >= rows_least, "at least 20 likelihood rows", options.likelihood_rows);
    expect(options.starts >= 1, "at least 1 start", options.starts);
    expect(options.evaluations_per_start >= 1, "at least 1 evaluation per start",
           options.evaluations_per_start);
    expect(options.refinement_evaluations >= 0, "at least 0 evaluations of the refinement",
           options.refinement_evaluations);
    expect(options.threads >= 1, "at least 1 thread", options.threads);
    const double least = least_forgetting_factor(options.feature_count);
    expect(options.forgetting_factor >= least && options.forgetting_factor <= 1,
           "a forgetting factor from 1 - 1/(2 features) = " + std::to_string(least) + " to 1",
           options.forgetting_factor);
}

/// The rows that training uses, and for what.
struct TrainingRows {
    RowList usable;     // for the start state
    RowList moving;     // for scales and offsets
    RowList likelihood; // for the exact kernel
};

TrainingRows choose_rows(const TrainingData& data, const TrainingOptions& options) {
    TrainingRows rows;
    rows.usable = usable_rows(data.gap_before, options.lags);
    const MotionSplit split = split_by_motion(data.positions, rows.usable, options.lags);
    if (split.moving.size() < rows_least) {
        throw InputError("training data: expected at least " + std::to_string(rows_least) +
                         " rows in motion with " + std::to_string(options.lags) +
                         " rows before them without a gap, found " + std::to_string(split.moving.size()));
    }
    rows.moving = split.moving;
    rows.likelihood = likelihood_rows(split, options.likelihood_rows);
    return rows;
}

std::unique_ptr<RowFamily> make_rows(const TrainingOptions& options, const LagSpread& spread) {
    switch (options.input) {
    case InputKind::DF:
        return identity_rows(options.lags);
    case InputKind::DFW:
        return diagonal_rows(options.lags);
    case InputKind::DFSR:
        return structured_rows(options.lags);
    default:
        return free_rows(options.lags, options.rows_per_joint, spread.pooled_factor());
    }
}

/// The input over the rows `at`, scaled over the rows in motion.
std::unique_ptr<InputMap> make_input(const TrainingData& data, const TrainingRows& rows, const RowList& at,
                                     const TrainingOptions& options) {
    const LagSpread spread(data.positions, rows.moving, options.lags);
    if (options.input == InputKind::STD) {
        return derivative_input(data, at, rows.moving, spread);
    }
    return lag_input(data.positions, at, spread, make_rows(options, spread));
}

MatrixXd rows_of(const MatrixXd& matrix, const RowList& rows) { return matrix(rows, Eigen::all); }

/// The outputs of the likelihood rows around `offset`; InputError for one that is constant there.
MatrixXd centred_outputs(const TrainingData& data, const RowList& rows, const VectorXd& offset) {
    const MatrixXd outputs = rows_of(data.outputs, rows);
    for (Index k = 0; k < outputs.cols(); ++k) {
        if (outputs.col(k).minCoeff() == outputs.col(k).maxCoeff()) {
            throw InputError("training data: expected outputs that vary, found " +
                             data.output_names[static_cast<std::size_t>(k)] + " constant at " +
                             number_text(outputs(0, k)) + " over the rows in motion");
        }
    }
    return outputs.rowwise() - offset.transpose();
}

std::vector<double> to_vector(const VectorXd& vector) {
    return {vector.data(), vector.data() + vector.size()};
}

LimitModel limits_of(const TrainingData& data) {
    const VectorXd positions = limit_factor * data.positions.cwiseAbs().colwise().maxCoeff().transpose();
    const VectorXd outputs = limit_factor * data.outputs.cwiseAbs().colwise().maxCoeff().transpose();
    return {to_vector(positions.cwiseMax(2 * std::numbers::pi)), to_vector(outputs)};
}

const Minimum& best_of(const std::vector<Minimum>& minima) {
    const auto best = std::min_element(minima.begin(), minima.end(),
                                       [](const Minimum& a, const Minimum& b) { return a.value < b.value; });
    if (!std::isfinite(best->value)) {
        throw InputError("training: expected a finite likelihood from at least one of " +
                         std::to_string(minima.size()) + " starts, found none");
    }
    return *best;
}

/// Where a search ended.
struct Fit {
    VectorXd theta;
    VectorXd output_variance;
};

/// Goes on from `fit` by the likelihood of the features that will run, over all usable rows.
Fit refine(const Fit& fit, const TrainingData& data, const TrainingRows& rows, const VectorXd& offset,
           const TrainingOptions& options, const Bounds& bounds) {
    const std::unique_ptr<InputMap> input = make_input(data, rows, rows.usable, options);
    const auto inputs = static_cast<int>(input->inputs(fit.theta.tail(fit.theta.size() - 2)).cols());
    const FeatureModel features =
        draw_features(options.feature_count, inputs, options.orthogonal, 1, options.seed);
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const FeatureLikelihood likelihood(
        *input, rows_of(data.outputs, rows.usable).rowwise() - offset.transpose(),
        Eigen::Map<const RowMajor>(features.omega.data(), options.feature_count, inputs));
    const auto value_of = [&likelihood](const VectorXd& theta) -> std::optional<PointValue> {
        const auto value = likelihood.evaluate(theta);
        return value ? std::optional(value->point) : std::nullopt;
    };
    const Minimum minimum = minimise(value_of, bounds, fit.theta, 0.1, options.refinement_evaluations);
    if (!std::isfinite(minimum.value)) {
        return fit;
    }
    return {minimum.point, likelihood.evaluate(minimum.point)->output_variance};
}

TrainingRecord record_of(const std::vector<Minimum>& minima, const TrainingOptions& options,
                         std::size_t rows) {
    TrainingRecord record;
    record.method = "ML";
    record.seed = options.seed;
    record.likelihood_rows = static_cast<int>(rows);
    record.log_likelihood = -0.5 * best_of(minima).value;
    for (const Minimum& minimum : minima) {
        if (std::isfinite(minimum.value)) {
            record.all_starts.push_back(-0.5 * minimum.value);
        }
    }
    return record;
}

} // namespace

TrainedModel train(const TrainingData& data, const TrainingOptions& options,
                   const ProgressCallback& progress) {
    check_options(options);
    check_training_data(data, options.input);
    const TrainingRows rows = choose_rows(data, options);
    const VectorXd offset = rows_of(data.outputs, rows.moving).colwise().mean().transpose();
    const std::unique_ptr<InputMap> input = make_input(data, rows, rows.likelihood, options);
    const ProfiledVarianceLikelihood outputs(centred_outputs(data, rows.likelihood, offset));
    const MarginalLikelihood likelihood(*input, outputs);
    const std::vector<Minimum> minima = search_all_starts(likelihood, options, progress);
    Fit fit{best_of(minima).point, {}};
    fit.output_variance = likelihood.evaluate(fit.theta)->output_variance;
    if (options.refinement_evaluations > 0) {
        fit = refine(fit, data, rows, offset, options, likelihood.bounds());
    }
    const Hyperparameters parameters = likelihood.split(fit.theta);

    TrainedModel model;
    model.joints = static_cast<int>(data.positions.cols());
    model.sample_period_s = data.sample_period_s;
    model.forgetting_factor = options.forgetting_factor;
    model.input = input->model(parameters.input);
    model.input.kind = options.input;
    model.input.lags = options.lags;
    model.input.position_noise_bound = options.position_noise_bound;
    model.features = draw_features(options.feature_count, model.joints * model.input.rows_per_joint,
                                   options.orthogonal, parameters.length_scale, options.seed);
    model.outputs.names = data.output_names;
    model.outputs.offset = to_vector(offset);
    model.outputs.noise_std = to_vector((parameters.noise_ratio * fit.output_variance).cwiseSqrt());
    model.outputs.prior_variance = 1 / parameters.noise_ratio;
    model.limits = limits_of(data);
    model.start = batch_start(model, data, rows.usable);
    model.training = record_of(minima, options, rows.likelihood.size());
    return model;
}

} // namespace dfdyn::tools
