// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/seed.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tests/tools/training/synthetic_physics.hpp"
#include "tools/base/text/error.hpp"
#include "tools/model/structure.hpp"
#include "tools/training/data/input_map.hpp"
#include "tools/training/data/lag_window.hpp"
#include "tools/training/likelihood/random_features.hpp"
#include "tools/training/physics/physics_columns.hpp"
#include "tools/training/train.hpp"

#include <string>

namespace train_physics_test {

namespace tools = dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using tools::HyperMethod;
using tools::InputKind;
using tools::Structure;
namespace structures = tools::structures;

constexpr int lags = 5;

/// An arm of three joints with two outputs: physics of six columns, friction that is not among them, and
/// noise.
struct Arm {
    tools::NormalSource random{dfdyn::tests::seed()};
    tools::TrainingData data = dfdyn::tests::arm_data(500, 3, 2, random);
    dfdyn::tests::SyntheticRegressor regressor{3, 2, 6, random};
    VectorXd truth{{2, -1, 3, 1.5, -2, 1}};
    tools::TrainingOptions options;

    Arm() {
        data.outputs = outputs_of(data);
        options.lags = lags;
        options.feature_count = 60;
        options.likelihood_rows = 150;
        options.starts = 2;
        options.evaluations_per_start = 40;
        options.refinement_evaluations = 5;
        options.physics.regressor = &regressor;
    }

    MatrixXd outputs_of(const tools::TrainingData& motion) {
        const MatrixXd columns =
            tools::all_columns(regressor, {motion.positions, motion.velocities, motion.accelerations});
        MatrixXd outputs(500, 2);
        for (Index k = 0; k < 2; ++k) {
            outputs.col(k) = columns.middleCols(6 * k, 6) * truth +
                             (3 * motion.velocities.col(k)).array().tanh().matrix() +
                             0.05 * random.matrix(500, 1);
        }
        return outputs;
    }

    /// The same motion with `factor` times the amplitude.
    tools::TrainingData widened(double factor) {
        tools::TrainingData wide = data;
        wide.positions *= factor;
        wide.velocities *= factor;
        wide.accelerations *= factor;
        wide.outputs = outputs_of(wide);
        return wide;
    }

    std::string message() const {
        try {
            tools::train(data, options);
        } catch (const tools::InputError& error) {
            return error.what();
        }
        return "";
    }
};

/// Predictions for the rows `rows` of `data` by the firmware's formulas, from the stored numbers alone.
inline MatrixXd predictions(const Arm& arm, const tools::TrainingResult& result,
                            const tools::TrainingData& data, const tools::RowList& rows) {
    const tools::TrainedModel& model = result.model;
    const tools::TrainedPhysics physics = result.physics.value_or(tools::TrainedPhysics{});
    tools::MotionSamples motion{data.positions(rows, Eigen::all), data.velocities(rows, Eigen::all),
                                data.accelerations(rows, Eigen::all)};
    if (physics.motion_rows.size() > 0) {
        const MatrixXd windows = tools::lag_windows(data.positions, rows, lags);
        for (Index joint = 0; joint < 3; ++joint) {
            const auto window = windows.middleCols(joint * (lags + 1), lags + 1);
            motion.positions.col(joint) = window * physics.motion_rows.row(0).transpose();
            motion.velocities.col(joint) = window * physics.motion_rows.row(1).transpose();
            motion.accelerations.col(joint) = window * physics.motion_rows.row(2).transpose();
        }
    }
    const MatrixXd columns = tools::all_columns(arm.regressor, motion);
    const VectorXd& pi = physics.start.parameters;
    MatrixXd result_matrix(columns.rows(), 2);
    for (Index k = 0; k < 2; ++k) {
        const double noise = model.outputs.noise_std[static_cast<std::size_t>(k)];
        VectorXd scaled = VectorXd::Zero(columns.rows());
        for (Index c = 0; c < pi.size(); ++c) {
            const Index column = 6 * k + physics.columns[static_cast<std::size_t>(c)];
            scaled += columns.col(column) * (physics.column_scale[c] / noise * pi[c]);
        }
        if (model.features.count > 0) {
            const Index size = 2 * model.features.count;
            VectorXd weights = Eigen::Map<const VectorXd>(model.start.weights.data() + k * size, size);
            if (!physics.start.coupling.empty()) {
                weights -= physics.start.coupling[static_cast<std::size_t>(k)] * pi;
            }
            scaled += tools::random_features(model.features, tools::stored_inputs(model.input, data, rows)) *
                      weights;
        }
        result_matrix.col(k) = model.outputs.offset[static_cast<std::size_t>(k)] + (noise * scaled).array();
    }
    return result_matrix;
}

inline double relative_error(const MatrixXd& predicted, const MatrixXd& measured) {
    const MatrixXd centred = measured.rowwise() - measured.colwise().mean();
    return (predicted - measured).norm() / centred.norm();
}

} // namespace train_physics_test
