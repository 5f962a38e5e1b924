// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/likelihood/marginal_likelihood.hpp"
#include "tools/training/search/hold_out.hpp"
#include "tools/training/search/training_setup.hpp"
#include "tools/training/training_progress.hpp"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace dfdyn::tools {

/// The physics of a fitted model.
struct PhysicsPart {
    ColumnChoice choice;
    Eigen::VectorXd motion; ///< the parameters of TrainingSetup::physics() for the input's kind
    PhysicsFit fit;         ///< in units of choice.scale
};

/// The hyperparameters of a model.
struct Fit {
    Hyperparameters hyper;           ///< P: the input's only
    Eigen::VectorXd output_variance; ///< rho_k^2; P: sigma_k^2
    Eigen::VectorXd offset;
    std::optional<PhysicsPart> physics; ///< empty for NP
    TrainingRecord record;
    std::vector<HoldOutPoint> hold_out; ///< CV only
};

/// Fits by marginal likelihood. Throws InputError if no start has a finite likelihood.
Fit fit_by_likelihood(const TrainingSetup& setup, const ProgressCallback& progress);

/// Fits by cross validation on a grid (paper, Section IV-C). Inputs and motion have the parameters of their
/// first start. Throws InputError if no point of the grid has a finite error.
Fit fit_by_hold_out(const TrainingSetup& setup, const ProgressCallback& progress);

} // namespace dfdyn::tools
