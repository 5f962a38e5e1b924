// SPDX-License-Identifier: Apache-2.0
#include "tools/training/train.hpp"

#include "tools/base/numerics/to_vector.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/training/data/lag_spacing.hpp"
#include "tools/training/likelihood/random_features.hpp"
#include "tools/training/search/fit.hpp"
#include "tools/training/search/training_setup.hpp"
#include "tools/training/start/batch_start.hpp"
#include "tools/training/start/extrapolation.hpp"
#include "tools/training/start/limits.hpp"
#include "tools/training/start/normal_equations.hpp"
#include "tools/training/start/robot_prior.hpp"
#include "tools/training/training_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns the model without its initial state.
TrainedModel model_of(const TrainingSetup& setup, const Fit& fit) {
    const TrainingOptions& options = setup.options;
    const TrainingData& data = setup.data;
    TrainedModel model;
    model.structure = options.model->name;
    model.joints = static_cast<int>(data.positions.cols());
    model.sample_period_s = data.sample_period_s;
    model.forgetting_factor = options.forgetting_factor;
    model.input = setup.input(options.input, setup.rows.likelihood)->model(fit.hyper.input);
    model.input.kind = options.input;
    model.input.lags = options.lags;
    model.input.position_noise_bound = options.position_noise_bound;
    model.outputs.names = data.output_names;
    model.outputs.offset = to_vector(fit.offset);
    model.limits = limits_of(data);
    model.training = fit.record;
    if (!options.model->features) {
        model.outputs.noise_std = to_vector(VectorXd(fit.output_variance.cwiseSqrt()));
        return model;
    }
    model.features = draw_features(options.feature_count, model.joints * model.input.rows_per_joint,
                                   options.orthogonal, fit.hyper.length_scale, options.seed);
    model.outputs.noise_std = to_vector(VectorXd((fit.hyper.noise_ratio * fit.output_variance).cwiseSqrt()));
    model.outputs.prior_variance = 1 / fit.hyper.noise_ratio;
    return model;
}

MatrixXd full_motion_rows(const TrainingSetup& setup, const VectorXd& parameters) {
    const std::unique_ptr<MotionRows> rows = setup.motion_rows(setup.options.input);
    if (rows == nullptr) {
        return {};
    }
    MatrixXd full = MatrixXd::Zero(3, setup.options.lags + 1);
    full(0, 0) = 1;
    full.bottomRows(2) = rows->evaluate(parameters);
    return full;
}

/// Reduces the scales of parameters whose prior standard deviation, column_scale gamma, exceeds their
/// plausible size.
void bound_prior(TrainedPhysics& physics, const VectorXd& parameter_size) {
    const double deviation = std::sqrt(physics.prior_variance);
    for (Index c = 0; c < physics.column_scale.size() && parameter_size.size() > 0 && deviation > 0; ++c) {
        const double size = parameter_size[physics.columns[static_cast<std::size_t>(c)]];
        physics.column_scale[c] = std::min(physics.column_scale[c], size / deviation);
    }
}

/// Returns the units of the parameters in which the prior is gamma^2 I and psi~ has order 1, if the options
/// permit this.
TrainedPhysics units_of(const TrainingSetup& setup, const PhysicsPart& part, const OutputModel& outputs) {
    const PhysicsOptions& options = setup.options.physics;
    TrainedPhysics physics;
    physics.columns = part.choice.columns;
    physics.column_scale = part.choice.scale;
    const VectorXd& prior = part.fit.prior_variance;
    physics.prior_variance = prior.size() == 0 ? 0 : prior[0];
    if (options.prior == PriorForm::diagonal && prior.size() > 0) {
        physics.column_scale = physics.column_scale.cwiseProduct(prior.cwiseSqrt());
        physics.prior_variance = 1;
    } else if (options.prior != PriorForm::unit) {
        const Eigen::Map<const VectorXd> noise(outputs.noise_std.data(),
                                               static_cast<Index>(outputs.noise_std.size()));
        const double unit = std::exp((noise.array() / output_deviations(setup).array()).log().mean());
        physics.column_scale *= unit;
        physics.prior_variance /= unit * unit;
    }
    bound_prior(physics, options.parameter_size);
    return physics;
}

/// Returns the targets of the features in units of noise_std: the outputs minus the physics (columns of
/// physics.columns at the usable rows, N x (m p)).
MatrixXd feature_targets(const TrainingSetup& setup, const OutputModel& outputs, const MatrixXd& columns,
                         const VectorXd& parameters) {
    MatrixXd targets = scaled_outputs(outputs, setup.data.outputs, setup.rows.usable);
    for (Index k = 0; k < targets.cols(); ++k) {
        targets.col(k) -= columns.middleCols(k * parameters.size(), parameters.size()) * parameters /
                          outputs.noise_std[static_cast<std::size_t>(k)];
    }
    return targets;
}

/// Returns the prior from the robot's own parameters; empty if they are unknown or the paper's prior is
/// requested.
std::optional<ParameterPrior> knowledge_of(const TrainingSetup& setup, const ColumnChoice& choice,
                                           const VectorXd& motion) {
    const PhysicsOptions& physics = setup.options.physics;
    if (!setup.options.shrinkage || physics.nominal.size() == 0 || physics.given) {
        return std::nullopt;
    }
    return robot_prior(setup, choice, motion);
}

/// Sets the initial state of the model, and returns its physics.
TrainedPhysics start_physics(const TrainingSetup& setup, const PhysicsPart& part, TrainedModel& model) {
    const Structure& structure = *setup.options.model;
    TrainedPhysics physics = units_of(setup, part, model.outputs);
    physics.motion_rows = full_motion_rows(setup, part.motion);
    const ColumnChoice choice{physics.columns, physics.column_scale};
    const MatrixXd columns =
        setup.physics(setup.options.input, setup.rows.usable, choice)->evaluate(part.motion);
    const PhysicsProblem problem{model, setup.data, setup.rows.usable, columns};
    const std::optional<ParameterPrior> robot = knowledge_of(setup, choice, part.motion);
    const auto p = static_cast<Index>(choice.columns.size());
    const InitialState start =
        robot ? initial_state_of(structure, problem, *robot, std::nullopt)
              : initial_state_of(
                    structure, problem, ParameterPrior::independent(p, physics.prior_variance),
                    part.fit.parameters.cwiseProduct(part.choice.scale.cwiseQuotient(choice.scale)));
    model.start = start.kernel;
    physics.start = start.physics;
    if (!setup.options.shrinkage) {
        return physics;
    }
    if (structure.features) {
        model.extrapolation =
            measure_extrapolation(model, setup.data, setup.rows.usable,
                                  feature_targets(setup, model.outputs, columns, start.physics.parameters));
        if (robot && structure.coupled()) {
            model.extrapolation->parameter_variance_factor = parameter_variance_factor(setup);
            model.extrapolation->output_variance = output_variances(model, setup.data, setup.rows.usable);
        }
    } else if (robot) {
        model.extrapolation =
            measure_parametric_extrapolation(problem, *robot, parameter_variance_factor(setup));
    }
    return physics;
}

/// Runs train() with the lags of `data`.
TrainingResult train_unspaced(const TrainingData& data, const TrainingOptions& options,
                              const ProgressCallback& progress) {
    const TrainingSetup setup(data, options);
    check_outputs_vary(setup);
    const Fit fit = options.hyper == HyperMethod::ML ? fit_by_likelihood(setup, progress)
                                                     : fit_by_hold_out(setup, progress);
    if (progress) {
        TrainingProgress starting;
        starting.searching = false;
        progress(starting);
    }
    TrainingResult result{model_of(setup, fit), std::nullopt, fit.hold_out, setup.spread.held_joints()};
    if (fit.physics) {
        result.physics = start_physics(setup, *fit.physics, result.model);
    } else {
        result.model.start = batch_start(result.model, data, setup.rows.usable);
        if (options.shrinkage) {
            result.model.extrapolation =
                measure_extrapolation(result.model, data, setup.rows.usable,
                                      scaled_outputs(result.model.outputs, data.outputs, setup.rows.usable));
        }
    }
    return result;
}

} // namespace

TrainingResult train(const TrainingData& data, const TrainingOptions& options,
                     const ProgressCallback& progress) {
    check_options(options, data);
    check_training_data(data, options.input);
    if (options.every == 1) {
        return train_unspaced(data, options, progress);
    }
    TrainingResult result = train_unspaced(spaced_data(data, options.every), options, progress);
    result.model.sample_period_s = data.sample_period_s;
    result.model.input = dense_input(std::move(result.model.input), options.every);
    if (result.physics) {
        result.physics->motion_rows = dense_rows(result.physics->motion_rows, options.every);
    }
    return result;
}

} // namespace dfdyn::tools
