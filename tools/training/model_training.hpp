// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/identification/torque_gains.hpp"
#include "tools/robot/robot.hpp"
#include "tools/training/train.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The robot for models P, SP, SP2 and SPK.
struct RobotPhysics {
    Robot robot;
    std::vector<std::string> effects; ///< in addition to the rigid body; names as in find_effect_kind()
    /// v > 0 of dry friction's tanh(qd / v), rad/s. Empty: most_likely_sign_velocity() for
    /// PhysicsMotion::free and ML, otherwise usual_sign_velocity.
    std::optional<double> sign_velocity;
    std::vector<double> torque_constants; ///< N·m/A of each joint, for currents; empty: estimated
};

/// Source of velocities and accelerations for input STD.
enum class DerivativeSource {
    automatic, ///< the recording's columns qd and qdd if it has both, otherwise estimated
    measured,  ///< the columns; an error if they are missing
    estimated, ///< from the positions, by the adaptive window
};

struct ModelTraining {
    TrainingOptions options; ///< `physics.regressor` and `position_noise_bound` are set by the training
    std::optional<RobotPhysics> physics; ///< used unless the model is NP
    DerivativeSource derivatives = DerivativeSource::automatic;
};

/// Training data with the derivatives that the training needs.
struct PreparedTraining {
    std::span<const Recording> recordings; ///< must exist as long as this
    TrainingData data;                     ///< of all recordings
    Derivatives derivatives = Derivatives::estimated;
    double position_noise_bound = 0;
};

/// Reads the recordings' samples. Throws InputError as gather_training_data() does, and if the recordings
/// lack derivatives.
PreparedTraining prepare_training(std::span<const Recording> recordings, const ModelTraining& training);

/// A model and further results of its training.
struct ModelTrainingResult {
    TrainedModel model;
    std::vector<HoldOutPoint> hold_out;        ///< CV: the errors over the grid
    std::vector<TorqueGain> torque_gains;      ///< of each joint, for physics of currents
    std::vector<std::size_t> held_joints = {}; ///< see TrainingResult
};

/// Trains a model on `prepared`; see train(). The caller sets `training.rows`, `training.recordings` and the
/// innovation limit. Throws InputError also for physics without a robot, and for estimated torque constants
/// that no motor has.
ModelTrainingResult train_model(const PreparedTraining& prepared, OutputKind outputs,
                                const ModelTraining& training, const ProgressCallback& progress);

/// Computes the initial state of `model` again, for another draw of features or other data: batch least
/// squares over all usable samples of `prepared` with the model's hyperparameters, motion and features. Only
/// for a model trained without shrinkage: the prior does not include the robot's own parameters.
void restart_model(TrainedModel& model, const PreparedTraining& prepared);

} // namespace dfdyn::tools
