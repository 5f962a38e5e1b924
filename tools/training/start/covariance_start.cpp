// SPDX-License-Identifier: Apache-2.0
#include "tools/training/start/covariance_start.hpp"

#include "tools/base/text/error.hpp"
#include "tools/training/start/normal_equations.hpp"

namespace dfdyn::tools {

void store_covariance(const Eigen::MatrixXd& covariance, std::vector<double>& unit_upper,
                      std::vector<double>& diagonal) {
    const std::optional<CovarianceFactor> factor = CovarianceFactor::of(covariance);
    if (!factor) {
        throw InputError("start of learning: expected a positive definite covariance, found another");
    }
    store_inverse(information_factor(factor->inverse(), 1), unit_upper, diagonal);
}

} // namespace dfdyn::tools
