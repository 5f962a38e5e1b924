// SPDX-License-Identifier: Apache-2.0
#include "tools/training/model_training.hpp"

#include "tools/base/numerics/to_vector.hpp"
#include "tools/base/text/error.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/model/effects.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/model/run_time/host_model.hpp"
#include "tools/model/structure.hpp"
#include "tools/robot/motion.hpp"
#include "tools/training/data/lag_spacing.hpp"
#include "tools/training/data/recorded_data.hpp"
#include "tools/training/data/stored_motion.hpp"
#include "tools/training/physics/parameter_sizes.hpp"
#include "tools/training/physics/robot_regressor.hpp"
#include "tools/training/sign_velocity.hpp"
#include "tools/training/start/batch_start.hpp"
#include "tools/training/start/limits.hpp"
#include "tools/training/training_options.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool have_derivatives(std::span<const Recording> recordings) {
    return std::ranges::all_of(recordings, [](const Recording& recording) {
        return recording.velocity.present() && recording.acceleration.present();
    });
}

/// Returns which derivatives a recording has, and which it lacks.
std::string found_derivatives(const Recording& recording) {
    const auto names = [&](const char* quantity) {
        return quantity + std::string("1…") + quantity + std::to_string(recording.joint_count());
    };
    const bool velocity = recording.velocity.present();
    return velocity == recording.acceleration.present()
               ? "none"
               : names(velocity ? "qd" : "qdd") + ", but no " + names(velocity ? "qdd" : "qd");
}

/// Returns the joints' effort limits; 0 if the URDF has none.
std::vector<double> joint_efforts(const Robot& robot) {
    std::vector<double> efforts;
    for (const RobotJoint& joint : robot.joints) {
        efforts.push_back(joint.effort.value_or(0));
    }
    return efforts;
}

/// The chain, its effects and the output gains.
struct PhysicsColumnsOf {
    ChainModel chain;
    std::vector<EffectModel> effects;
    std::vector<double> output_gain;
};

std::vector<TorqueGain> gains_for(const RobotPhysics& robot, OutputKind outputs,
                                  std::span<const Recording> recordings) {
    return torque_gains(robot.robot, outputs, robot.torque_constants, [&] {
        return estimate_torque_gains(robot.robot, recorded_motion(recordings, rigid_body_window(recordings)),
                                     robot.sign_velocity.value_or(usual_sign_velocity));
    });
}

PhysicsColumnsOf physics_columns_of(const RobotPhysics& robot, OutputKind outputs,
                                    std::vector<double> gains) {
    PhysicsColumnsOf columns{chain_model(robot.robot, outputs), {}, std::move(gains)};
    columns.effects =
        effect_models(robot.effects, columns.chain, robot.sign_velocity.value_or(usual_sign_velocity));
    return columns;
}

/// Chooses the velocity of dry friction's sign if nobody gave it.
void choose_sign_velocity(const TrainingData& data, const TrainingOptions& options, const RobotPhysics& robot,
                          PhysicsColumnsOf& columns) {
    const bool own_motion =
        options.physics.motion == PhysicsMotion::free && !input_description(options.input).uses_derivatives();
    if (robot.sign_velocity || !sign_velocity_of(columns.effects) || !own_motion ||
        options.hyper != HyperMethod::ML) {
        return;
    }
    const auto effects_at = [&](double sign_velocity) {
        return effect_models(robot.effects, columns.chain, sign_velocity);
    };
    columns.effects = effects_at(most_likely_sign_velocity(data, options, [&](double sign_velocity) {
        return robot_regressor(columns.chain, effects_at(sign_velocity), columns.output_gain);
    }));
}

void check_joints(const Robot& robot, const TrainingData& data) {
    const auto joints = static_cast<Index>(robot.joints.size());
    if (joints != data.positions.cols()) {
        throw InputError("robot " + robot.name + ": expected a chain of " +
                         std::to_string(data.positions.cols()) + " joints as the recording has, found " +
                         std::to_string(joints));
    }
}

/// Returns the motion input of the physics, as stored in a model.
InputModel motion_model(const TrainedModel& model, const MatrixXd& rows) {
    InputModel motion;
    if (rows.size() == 0) {
        motion = model.input; // STD: its derivatives
    } else {
        motion.kind = InputKind::DFR;
        motion.lags = static_cast<int>(rows.cols()) - 1;
        const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> by_rows = rows;
        motion.rows.assign(by_rows.data(), by_rows.data() + by_rows.size());
    }
    motion.rows_per_joint = 3;
    motion.scale.assign(3 * static_cast<std::size_t>(model.joints), 1);
    return motion;
}

StartModel start_model(const PhysicsStart& start) {
    return {to_vector(start.parameters), start.unit_upper, start.diagonal};
}

std::vector<double> flattened(const std::vector<MatrixXd>& coupling) {
    std::vector<double> result;
    for (const MatrixXd& of_output : coupling) {
        result.insert(result.end(), of_output.data(), of_output.data() + of_output.size());
    }
    return result;
}

PhysicsModel physics_model(const TrainedModel& model, const TrainedPhysics& trained,
                           const PhysicsColumnsOf& columns, const Robot& robot) {
    PhysicsModel physics;
    physics.chain = columns.chain;
    physics.effects = columns.effects;
    physics.output_gain = columns.output_gain;
    physics.motion = motion_model(model, trained.motion_rows);
    const std::vector<std::string> names = column_names(robot, columns.chain, columns.effects);
    for (const Index column : trained.columns) {
        physics.selected.push_back(static_cast<int>(column));
        physics.parameter_names.push_back(names[static_cast<std::size_t>(column)]);
    }
    physics.column_scale = to_vector(trained.column_scale);
    physics.prior_variance = trained.prior_variance;
    physics.start = start_model(trained.start);
    physics.coupling = flattened(trained.start.coupling);
    return physics;
}

/// With measured derivatives, input STD has no window.
void set_derivatives(TrainedModel& model, const PreparedTraining& prepared) {
    if (!input_description(model.input.kind).uses_derivatives() ||
        prepared.derivatives == Derivatives::estimated) {
        return;
    }
    model.input.derivatives = Derivatives::measured;
    model.input.lags = 0;
    model.input.position_noise_bound = 0;
}

/// Returns the selected columns in their units, N x (m p), in the order of PhysicsColumns.
MatrixXd columns_of(const PhysicsModel& physics, const TrainingData& data, const RowList& rows) {
    const auto regressor = robot_regressor(physics.chain, physics.effects, physics.output_gain);
    const ColumnChoice choice{{physics.selected.begin(), physics.selected.end()},
                              Eigen::Map<const VectorXd>(physics.column_scale.data(),
                                                         static_cast<Index>(physics.column_scale.size()))};
    return chosen_columns(*regressor, stored_motion(physics.motion, data, rows), choice);
}

int lags_of(const TrainedModel& model) {
    return std::max(structure_of(model).features ? model.input.lags : 0,
                    model.physics ? model.physics->motion.lags : 0);
}

} // namespace

PreparedTraining prepare_training(std::span<const Recording> recordings, const ModelTraining& training) {
    PreparedTraining prepared;
    prepared.recordings = recordings;
    prepared.data = gather_training_data(recordings);
    if (!input_description(training.options.input).uses_derivatives()) {
        return prepared;
    }
    const bool measured = have_derivatives(recordings);
    if (training.derivatives == DerivativeSource::measured && !measured) {
        throw InputError(recordings.front().source +
                         ": expected columns qd1… and qdd1… for measured derivatives, found " +
                         found_derivatives(recordings.front()));
    }
    if (measured && training.derivatives != DerivativeSource::estimated) {
        prepared.derivatives = Derivatives::measured;
        copy_derivatives(prepared.data, recordings);
        return prepared;
    }
    prepared.position_noise_bound = estimate_position_noise_bound(prepared.data);
    estimate_derivatives(prepared.data, recordings,
                         dense_lags({training.options.lags, training.options.every}),
                         prepared.position_noise_bound);
    return prepared;
}

ModelTrainingResult train_model(const PreparedTraining& prepared, OutputKind outputs,
                                const ModelTraining& training, const ProgressCallback& progress) {
    TrainingOptions options = training.options;
    options.position_noise_bound = prepared.position_noise_bound;
    if (!options.model->has_physics()) {
        TrainingResult result = train(prepared.data, options, progress);
        set_derivatives(result.model, prepared);
        return {std::move(result.model), std::move(result.hold_out), {}, std::move(result.held_joints)};
    }
    if (!training.physics) {
        throw InputError(std::string("model ") + options.model->name +
                         ": expected a robot (--robot, --tip), found none");
    }
    const RobotPhysics& robot = *training.physics;
    check_joints(robot.robot, prepared.data);
    std::vector<TorqueGain> gains = gains_for(robot, outputs, prepared.recordings);
    check_estimated_gains(gains);
    const auto output_count = static_cast<std::size_t>(prepared.data.outputs.cols());
    PhysicsColumnsOf columns = physics_columns_of(robot, outputs, output_gains(gains, output_count));
    options.physics.parameter_size = parameter_sizes(robot.robot, columns.chain, columns.effects);
    options.physics.nominal = expected_parameters(robot.robot, columns.chain, columns.effects);
    options.physics.nominal_deviation = parameter_deviations(robot.robot, columns.chain, columns.effects);
    choose_sign_velocity(prepared.data, options, robot, columns);
    const auto regressor = robot_regressor(columns.chain, columns.effects, columns.output_gain);
    options.physics.regressor = regressor.get();
    TrainingResult result = train(prepared.data, options, progress);
    TrainedModel model = std::move(result.model);
    set_derivatives(model, prepared);
    model.physics = physics_model(model, *result.physics, columns, robot.robot);
    check_parameters(*model.physics, options.physics.parameter_size);
    model.physics->motion_limit = motion_limits(model.physics->motion, prepared.data);
    if (outputs == OutputKind::joint_torque) {
        bound_by_efforts(model.limits, joint_efforts(robot.robot));
    }
    if (!structure_of(model).features) {
        model.input = {};
    }
    return {std::move(model), std::move(result.hold_out), std::move(gains), std::move(result.held_joints)};
}

void restart_model(TrainedModel& model, const PreparedTraining& prepared) {
    const RowList rows = usable_rows(prepared.data.gap_before, lags_of(model));
    if (!model.physics) {
        model.start = batch_start(model, prepared.data, rows);
        return;
    }
    PhysicsModel& physics = *model.physics;
    const MatrixXd columns = columns_of(physics, prepared.data, rows);
    const ParameterPrior prior =
        ParameterPrior::independent(static_cast<Index>(physics.selected.size()), physics.prior_variance);
    const InitialState start =
        initial_state_of(structure_of(model), {model, prepared.data, rows, columns}, prior,
                         Eigen::Map<const VectorXd>(physics.start.weights.data(),
                                                    static_cast<Index>(physics.start.weights.size())));
    model.start = start.kernel;
    physics.start = start_model(start.physics);
    physics.coupling = flattened(start.physics.coupling);
}

} // namespace dfdyn::tools
