// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/sample_grid.hpp"
#include "tools/model/model.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Input of the training: T samples of n joints and m outputs, in order of time unless `time_order` contains
/// another order.
struct TrainingData {
    Eigen::MatrixXd positions; ///< T x n, rad
    Eigen::MatrixXd outputs;   ///< T x m, in the recording's units
    /// T x n, rad/s and rad/s^2: measured (copy_derivatives()) or estimated (estimate_derivatives()). Used
    /// for input STD and to estimate torque gains; empty otherwise.
    Eigen::MatrixXd velocities, accelerations;
    /// T flags: 1 if the row does not directly follow the previous one
    std::vector<std::uint8_t> gap_before;
    /// T numbers that order the rows by time; empty: they are in order of time
    std::vector<Eigen::Index> time_order;
    std::vector<std::string> output_names; ///< m column names
    double sample_period_s = 0;            ///< copied into the model
    SteadyStride steady;                   ///< for a message about gaps
};

/// Throws InputError with row and column unless all shapes agree and every number that `kind` uses is finite.
void check_training_data(const TrainingData& data, InputKind kind);

} // namespace dfdyn::tools
