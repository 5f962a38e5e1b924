// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/smooth_functions.hpp"

#include <numbers>

namespace dfdyn::tools {

std::vector<Eigen::VectorXd> harmonics(const Eigen::VectorXd& input, int orders) {
    const double middle = (input.maxCoeff() + input.minCoeff()) / 2;
    const double half = (input.maxCoeff() - input.minCoeff()) / 2 + 1e-12;
    const Eigen::ArrayXd angle = std::numbers::pi / 2 * (input.array() - middle) / half;
    std::vector<Eigen::VectorXd> result;
    for (int order = 1; order <= orders; ++order) {
        result.emplace_back((order * angle).sin());
        result.emplace_back((order * angle).cos());
    }
    return result;
}

} // namespace dfdyn::tools
