// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/run/train_case.hpp"

#include "tools/model/file/model_file.hpp"
#include "tools/model/structure.hpp"
#include "tools/robot/urdf/read_robot.hpp"
#include "tools/training/likelihood/random_features.hpp"
#include "tools/training/model_training.hpp"
#include "tools/training/training_options.hpp"

#include <limits>
#include <span>

namespace dfdyn::tools {

namespace {

/// Seed of the searches' starts: equal for all draws, so that their order has no influence.
constexpr std::uint64_t search_seed = 1;

ModelTraining training_of(const Case& one, const RobotChoice& robot, int threads) {
    ModelTraining training;
    TrainingOptions& options = training.options;
    options.model = &structure(one.model);
    options.hyper = parse_hyper_method(one.hyper);
    options.input = one.input;
    options.lags = one.lags;
    options.rows_per_joint = one.rows_per_joint;
    options.feature_count = one.feature_count;
    options.orthogonal = one.orthogonal;
    options.relevance = one.relevance;
    options.centred = one.centred;
    options.forgetting_factor = one.forgetting_factor;
    options.likelihood_rows = one.likelihood_rows;
    options.starts = one.starts;
    options.refinement_evaluations = 0; // it would depend on the draw
    options.shrinkage = false;          // the paper's predictions; shrinkage would depend on the draw
    options.seed = search_seed;
    options.threads = threads;
    options.physics.motion = one.physics_input == "own" ? PhysicsMotion::poles : PhysicsMotion::of_input;
    options.physics.prior = parse_prior_form(one.prior);
    if (options.model->has_physics() && !robot.urdf.empty()) {
        training.physics.emplace();
        training.physics->robot = robot_of(robot);
        training.physics->effects = one.effects;
        training.physics->sign_velocity = robot.sign_velocity;
        training.physics->torque_constants = robot.torque_constants;
    }
    return training;
}

/// Trains the part that does not depend on the draw.
TrainedModel tune(const CaseContext& context, const ModelTraining& training, const PreparedTraining& prepared,
                  const std::function<void(double)>& progress) {
    TrainedModel model =
        train_model(prepared, context.outputs, training, [&progress](const TrainingProgress& done) {
            progress(static_cast<double>(done.evaluations) / static_cast<double>(done.evaluations_most));
        }).model;
    model.limits.innovation = static_cast<double>(std::numeric_limits<float>::max());
    model.limits.prediction.clear(); // the paper's predictions
    return model;
}

} // namespace

Robot robot_of(const RobotChoice& choice) {
    ReadRobotOptions options;
    options.base = choice.base;
    options.tip = choice.tip;
    options.gravity = Eigen::Vector3d(choice.gravity.data());
    options.ft_joint = choice.ft_joint;
    return read_robot(choice.urdf, options);
}

TrainedModel train_case(const Case& one, const CaseContext& context, std::uint64_t seed, CaseMemory& memory,
                        const std::function<void(double)>& progress) {
    const ModelTraining training = training_of(one, context.robot, context.threads);
    const PreparedTraining prepared = prepare_training(std::span(&context.start, 1), training);
    TrainedModel model;
    {
        const std::lock_guard lock(memory.tuning);
        if (!memory.tuned) {
            memory.tuned = tune(context, training, prepared, progress);
        }
        model = *memory.tuned;
    }
    if (structure_of(model).features) {
        model.features = draw_features(model.features.count, model.joints * model.input.rows_per_joint,
                                       model.features.orthogonal, model.features.length_scale, seed);
        restart_model(model, prepared);
    }
    return model;
}

} // namespace dfdyn::tools
