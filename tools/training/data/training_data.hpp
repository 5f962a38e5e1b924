// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// What training reads: T samples of n joints and m outputs, in order of time.
struct TrainingData {
    Eigen::MatrixXd positions;             ///< T x n, rad
    Eigen::MatrixXd outputs;               ///< T x m, in the recording's units
    Eigen::MatrixXd velocities;            ///< T x n, rad/s, estimated by the caller; read for input STD only
    Eigen::MatrixXd accelerations;         ///< T x n, rad/s^2, likewise
    std::vector<std::uint8_t> gap_before;  ///< T flags: 1 where the row does not follow the one before it
    std::vector<std::string> output_names; ///< m column names
    double sample_period_s = 0;            ///< copied into the model
};

/// Throws InputError that names row and column unless all shapes agree and every number that `kind` reads is
/// finite.
void check_training_data(const TrainingData& data, InputKind kind);

} // namespace dfdyn::tools
