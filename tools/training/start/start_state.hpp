// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/training/data/row_selection.hpp"
#include "tools/training/data/training_data.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

/// The regularised least-squares solution over `rows` (eq:ReLS) in double: with y~ = (y - offset) /
/// noise_std, Lambda = sum_t lambda^(N-t) phi phi' + lambda^(N-1) / prior_variance I, weights = Lambda^-1
/// sum_t lambda^(N-t) phi y~, U D U' = Lambda^-1. Reads forgetting_factor, input, features and outputs of
/// `model`. Under forgetting the prior keeps at least 1e-6 of its weight, so that Lambda stays regular where
/// the rows excite nothing. O(N (2d)^2 + (2d)^3). Throws InputError when Lambda cannot be factored.
StartModel batch_start(const TrainedModel& model, const TrainingData& data, const RowList& rows);

/// The same with `targets` (N x m) in place of y~.
StartModel batch_start(const TrainedModel& model, const TrainingData& data, const RowList& rows,
                       const Eigen::MatrixXd& targets);

} // namespace dfdyn::tools
