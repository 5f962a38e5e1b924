// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/training/data/row_selection.hpp"
#include "tools/training/data/training_data.hpp"
#include "tools/training/physics/physics_start.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

/// Measures what `model`, with its start, knows of the outputs away from its data. `targets`, N x m in units
/// of noise_std: what its features have to explain at `rows`.
///
///  - inverse_far_variance: 1 / (trace(P) / 2d) of the start; that is the mean of φ'Pφ over all phases of the
///  features.
///  - prior_variance: where nothing is known an output is taken to be uniform over plus and minus its
///    99 % quantile, so its variance about the offset is quantile^2 / 3 + offset^2.
///  - extra_noise: such that two standard deviations hold 95.4 % of errors out of sample near the data
///    (novelty below 0.1). Samples: five contiguous blocks in time, each predicted from the other four, and
///    each of these from one (block cross-validation: neighbouring rows are too alike to be held out alone).
///
/// Deterministic. At most 3000 rows are learned from and 600 predicted, evenly strided: O(n (2d)^2 + 10
/// (2d)^3) with n = 6000.
ExtrapolationModel measure_extrapolation(const TrainedModel& model, const TrainingData& data,
                                         const RowList& rows, const Eigen::MatrixXd& targets);

/// Of each output about its offset where nothing is known, in units of noise_std squared: it is taken to be
/// uniform over plus and minus its 99 % quantile at `rows`.
std::vector<double> output_variances(const TrainedModel& model, const TrainingData& data,
                                     const RowList& rows);

/// Likewise for P, whose start is the solution of `problem` under `prior`: extra_noise from the same blocks,
/// where the variance of the parameters, times `parameter_variance_factor`, explains its part of the errors.
/// O(n m p^2 + 10 p^3).
ExtrapolationModel measure_parametric_extrapolation(const PhysicsProblem& problem,
                                                    const ParameterPrior& prior,
                                                    double parameter_variance_factor);

} // namespace dfdyn::tools
