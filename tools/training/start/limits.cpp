// SPDX-License-Identifier: Apache-2.0
#include "tools/training/start/limits.hpp"

#include "tools/base/numerics/to_vector.hpp"

#include <algorithm>
#include <numbers>

namespace dfdyn::tools {
namespace {

using Eigen::VectorXd;

constexpr double measured_factor = 10;
constexpr double predicted_factor = 3;
constexpr double least_output = 1e-3; // for a channel that is always 0

} // namespace

LimitModel limits_of(const TrainingData& data) {
    const VectorXd positions = data.positions.cwiseAbs().colwise().maxCoeff().transpose();
    const VectorXd outputs = data.outputs.cwiseAbs().colwise().maxCoeff().transpose();
    LimitModel limits;
    limits.position_rad = to_vector(VectorXd((measured_factor * positions).cwiseMax(2 * std::numbers::pi)));
    limits.output = to_vector(VectorXd((measured_factor * outputs).cwiseMax(least_output)));
    limits.prediction = to_vector(VectorXd((predicted_factor * outputs).cwiseMax(least_output)));
    return limits;
}

void bound_by_efforts(LimitModel& limits, std::span<const double> efforts) {
    for (std::size_t k = 0; k < limits.prediction.size(); ++k) {
        double& limit = limits.prediction[k];
        if (efforts[k] >= limit / predicted_factor) {
            limit = std::min(limit, efforts[k]);
        }
    }
}

} // namespace dfdyn::tools
