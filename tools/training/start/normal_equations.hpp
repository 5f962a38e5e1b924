// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/training/data/row_selection.hpp"
#include "tools/training/data/training_data.hpp"
#include "tools/training/likelihood/covariance_factor.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Lambda w = b.
struct NormalEquations {
    Eigen::MatrixXd information;     ///< Lambda, lower triangle, without the prior
    Eigen::MatrixXd right_hand_side; ///< b, one column per target
};

/// Returns the sums over `rows` of lambda^(N-t) phi phi' and lambda^(N-t) phi target', with the random
/// features phi of `model`; `targets` has a row for each of `rows`. O(N (2d)^2), in blocks, so that memory
/// does not grow with N.
NormalEquations normal_equations(const TrainedModel& model, const TrainingData& data, const RowList& rows,
                                 const Eigen::MatrixXd& targets);

/// The square roots of lambda^(count-1) … 1.
Eigen::VectorXd forgetting_roots(double forgetting_factor, Eigen::Index count);

/// Weight of the prior after `count` rows with forgetting: lambda^(count-1), at least 1e-6, so that the
/// information matrix stays regular if the rows do not excite all columns.
double prior_weight(double forgetting_factor, Eigen::Index count);

/// (y - offset) / noise_std of the given rows.
Eigen::MatrixXd scaled_outputs(const OutputModel& model, const Eigen::MatrixXd& outputs, const RowList& rows);

/// Returns the factor of an information matrix with its prior. Throws InputError with `prior_variance` if it
/// is not positive definite.
CovarianceFactor information_factor(Eigen::MatrixXd information, double prior_variance);

/// Lambda = L L', so Lambda^-1 = L^-T L^-1 = U D U' with U D^(1/2) = L^-T; in the order of StartModel.
void store_inverse(const CovarianceFactor& factor, std::vector<double>& unit_upper,
                   std::vector<double>& diagonal);

/// Computes the factors U (strictly upper part, by columns, as in StartModel) and D of `covariance` = U D U'.
/// Throws InputError unless it is positive definite. O(p^3).
void store_covariance(const Eigen::MatrixXd& covariance, std::vector<double>& unit_upper,
                      std::vector<double>& diagonal);

} // namespace dfdyn::tools
