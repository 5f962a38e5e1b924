// SPDX-License-Identifier: Apache-2.0
#include "tools/model/inputs/row_family.hpp"

#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr double gain_most = 1e3;
constexpr double gain_least = 1e-3;
constexpr double perturbation = 0.5;

} // namespace

Bounds log_gain_bounds(Eigen::Index count) {
    return {Eigen::VectorXd::Constant(count, std::log(gain_least)),
            Eigen::VectorXd::Constant(count, std::log(gain_most))};
}

Eigen::VectorXd perturbed(const Eigen::VectorXd& base, int index, int fixed, NormalSource& random) {
    return index < fixed ? base : Eigen::VectorXd(base + perturbation * random.matrix(base.size(), 1));
}

} // namespace dfdyn::tools
