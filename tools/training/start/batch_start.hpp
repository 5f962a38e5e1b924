// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/training/data/row_selection.hpp"
#include "tools/training/data/training_data.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

/// Returns the regularised least-squares solution over `rows` (paper, Section IV-B) in double: with y~ = (y -
/// offset) / noise_std, Lambda = sum_t lambda^(N-t) phi phi' + lambda^(N-1) / prior_variance I, weights =
/// Lambda^-1 sum_t lambda^(N-t) phi y~, U D U' = Lambda^-1. Uses forgetting_factor, input, features and
/// outputs of `model`. With forgetting, the prior keeps at least 1e-6 of its weight, so that Lambda stays
/// regular if the rows do not excite all columns. O(N (2d)^2 + (2d)^3). Throws InputError if Lambda cannot be
/// factored.
StartModel batch_start(const TrainedModel& model, const TrainingData& data, const RowList& rows);

/// Returns the solution for `targets` (N x m) instead of y~.
StartModel batch_start(const TrainedModel& model, const TrainingData& data, const RowList& rows,
                       const Eigen::MatrixXd& targets);

} // namespace dfdyn::tools
