// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/data/input_map.hpp"
#include "tools/training/physics/physics_columns.hpp"
#include "tools/training/training_options.hpp"

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace dfdyn::tools {

/// The rows for each step of the training.
struct TrainingRows {
    RowList usable;     ///< for the start state, in order of time
    RowList moving;     ///< for scales and offsets
    RowList likelihood; ///< for the exact kernel
};

/// Throws InputError for fewer than 20 usable rows in motion.
TrainingRows choose_rows(const TrainingData& data, const TrainingOptions& options);

/// Common data of all steps of the training, and the objects made from it for any set of rows.
struct TrainingSetup {
    const TrainingData& data;
    const TrainingOptions& options;
    TrainingRows rows;
    LagSpread spread; ///< over the rows in motion

    TrainingSetup(const TrainingData& data, const TrainingOptions& options);

    /// Returns the input over the rows `at`, scaled over the rows in motion.
    std::unique_ptr<InputMap> input(InputKind kind, const RowList& at) const;

    /// Returns the rows of an input and their parameters. Not for inputs of derivatives.
    std::unique_ptr<RowFamily> row_family(InputKind kind) const;

    /// Returns the motion input of the regressor over the rows `at`, for an input of this kind.
    std::unique_ptr<LearnedMotion> motion(InputKind kind, const RowList& at) const;

    /// Returns the initial parameters of this motion: the input's, then its own.
    Eigen::VectorXd motion_start(InputKind kind) const;

    /// Returns the rows of this motion; null for the recording's derivatives.
    std::unique_ptr<MotionRows> motion_rows(InputKind kind) const;

    std::unique_ptr<PhysicsColumns> physics(InputKind kind, const RowList& at,
                                            const ColumnChoice& choice) const;

    Eigen::MatrixXd outputs(const RowList& at) const { return data.outputs(at, Eigen::all); }
};

/// Throws InputError with the name of an output that is constant over the likelihood rows.
void check_outputs_vary(const TrainingSetup& setup);

/// Returns the columns of the physics that the recording identifies with the initial motion. Their parameters
/// have the units of TrainedPhysics, without the factor of the outputs. Throws InputError if there is none.
ColumnChoice choose_columns(const TrainingSetup& setup);

/// Returns the model's output offset: the mean over the rows in motion for a centred NP, otherwise 0.
Eigen::VectorXd output_offset(const TrainingSetup& setup);

/// Returns the standard deviations of the outputs over the likelihood rows.
Eigen::VectorXd output_deviations(const TrainingSetup& setup);

} // namespace dfdyn::tools
