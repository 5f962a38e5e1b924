// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"
#include "tools/training/physics/torque_constants.hpp"
#include "tools/training/train.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The robot behind models P, SP, SP2 and SPK.
struct RobotPhysics {
    Robot robot;
    std::vector<std::string> effects;     ///< beside the rigid body, as find_effect_kind() knows them
    double sign_velocity = 0.05;          ///< v of Coulomb's tanh(qd / v), rad/s
    std::vector<double> torque_constants; ///< N·m/A of each joint, for currents; empty: estimated
};

/// Where input STD takes velocities and accelerations from.
enum class DerivativeSource {
    automatic, ///< the recording's columns qd and qdd where it has both, else estimated
    measured,  ///< the columns; an error without
    estimated, ///< from the positions, by the adaptive window
};

struct ModelTraining {
    TrainingOptions options;             ///< `physics.regressor` and `position_noise_bound` are filled in
    std::optional<RobotPhysics> physics; ///< read unless the model is NP
    DerivativeSource derivatives = DerivativeSource::automatic;
};

/// Whether the training looks at velocities and accelerations: with input STD, and to estimate torque
/// constants.
bool sees_derivatives(const ModelTraining& training);

/// What is trained on, with the derivatives that the training needs.
struct PreparedTraining {
    TrainingData data;
    Derivatives derivatives = Derivatives::estimated;
    double position_noise_bound = 0;
};

/// Reads the recordings' samples. Throws InputError as gather_training_data(), and for derivatives that the
/// recordings lack.
PreparedTraining prepare_training(std::span<const Recording> recordings, const ModelTraining& training);

/// A model, and what training found out beside it.
struct ModelTrainingResult {
    TrainedModel model;
    std::vector<HoldOutPoint> hold_out;   ///< CV: the errors over the grid
    std::vector<TorqueGain> torque_gains; ///< of each joint, for physics of currents
};

/// Trains a model on `prepared`; see train(). `training.rows`, `training.recordings` and the innovation limit
/// are left to the caller. Throws InputError also for physics without a robot.
ModelTrainingResult train_model(const PreparedTraining& prepared, OutputKind outputs,
                                const ModelTraining& training, const ProgressCallback& progress);

/// Computes the start of `model` again, by batch least squares over all usable samples of `prepared`, with
/// everything else as the model has it: its hyperparameters, motion, features. For another draw of features,
/// or other data. Of a model trained without shrinkage: the robot's own parameters are not in the prior.
void restart_model(TrainedModel& model, const PreparedTraining& prepared);

} // namespace dfdyn::tools
