// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/data/input_map.hpp"
#include "tools/training/physics/physics_columns.hpp"
#include "tools/training/train.hpp"

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace dfdyn::tools {

/// The rows that training uses, and for what.
struct TrainingRows {
    RowList usable;     ///< for the start state
    RowList moving;     ///< for scales and offsets
    RowList likelihood; ///< for the exact kernel
};

/// Throws InputError for fewer than 20 usable rows in motion.
TrainingRows choose_rows(const TrainingData& data, const TrainingOptions& options);

/// What all parts of training read, and what they make of it for any set of rows.
struct TrainingSetup {
    const TrainingData& data;
    const TrainingOptions& options;
    TrainingRows rows;
    LagSpread spread; ///< of the rows in motion

    TrainingSetup(const TrainingData& data, const TrainingOptions& options);

    /// The input over the rows `at`, scaled over the rows in motion.
    std::unique_ptr<InputMap> input(InputKind kind, const RowList& at) const;

    /// What the regressor sees over the rows `at` beside an input of that kind.
    std::unique_ptr<LearnedMotion> motion(InputKind kind, const RowList& at) const;

    /// The parameters of that motion that training begins with: the input's, then its own.
    Eigen::VectorXd motion_start(InputKind kind) const;

    /// The rows of that motion; nothing for the recording's derivatives.
    std::unique_ptr<MotionRows> motion_rows(InputKind kind) const;

    std::unique_ptr<PhysicsColumns> physics(InputKind kind, const RowList& at,
                                            const ColumnChoice& choice) const;

    Eigen::MatrixXd outputs(const RowList& at) const { return data.outputs(at, Eigen::all); }
};

/// Throws InputError that names an output that is constant over the likelihood rows.
void check_outputs_vary(const TrainingSetup& setup);

/// The columns of the physics that the recording identifies with the motion that training begins with, and
/// the units of their parameters (see TrainedPhysics, before the factor of the outputs). Throws InputError if
/// there is none.
ColumnChoice choose_columns(const TrainingSetup& setup);

/// What the model adds to everything: NP's mean over the rows in motion if it is centred; else 0.
Eigen::VectorXd output_offset(const TrainingSetup& setup);

/// Standard deviations of the outputs over the likelihood rows.
Eigen::VectorXd output_deviations(const TrainingSetup& setup);

} // namespace dfdyn::tools
