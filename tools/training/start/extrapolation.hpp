// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/training/data/row_selection.hpp"
#include "tools/training/data/training_data.hpp"
#include "tools/training/start/initial_state.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

/// Measures the uncertainty of `model`, in its initial state, away from its data. `targets`: N x m in units
/// of noise_std, the part of the outputs at `rows` that the features must explain.
///
/// - inverse_far_variance: 1 / (trace(P) / 2d) of the initial state; trace(P) / 2d is the mean of φ'Pφ over
///   all phases of the features.
/// - prior_variance: away from all data, an output is assumed uniform within plus and minus its 99 %
///   quantile. Its variance about the offset is therefore quantile^2 / 3 + offset^2.
/// - extra_noise: chosen so that two standard deviations contain 95.4 % of held-out errors near the data
///   (novelty below 0.1). The errors are from block cross-validation, because neighbouring rows are too
///   similar to be held out individually: five contiguous blocks in time, each predicted from the other four
///   and from each single other one.
///
/// Deterministic. At most 3000 rows are used for learning and 600 for prediction, evenly strided: O(n (2d)^2
/// + 10 (2d)^3) with n = 6000.
ExtrapolationModel measure_extrapolation(const TrainedModel& model, const TrainingData& data,
                                         const RowList& rows, const Eigen::MatrixXd& targets);

/// Returns the variance of each output about its offset away from all data, in units of noise_std squared.
/// The output is assumed uniform within plus and minus its 99 % quantile at `rows`.
std::vector<double> output_variances(const TrainedModel& model, const TrainingData& data,
                                     const RowList& rows);

/// Measures the uncertainty for P, whose initial state is the solution of `problem` under `prior`.
/// extra_noise is from the same blocks; the variance of the parameters, times `parameter_variance_factor`,
/// explains its part of the errors. O(n m p^2 + 10 p^3).
ExtrapolationModel measure_parametric_extrapolation(const PhysicsProblem& problem,
                                                    const ParameterPrior& prior,
                                                    double parameter_variance_factor);

} // namespace dfdyn::tools
