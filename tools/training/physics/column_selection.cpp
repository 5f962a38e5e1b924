// SPDX-License-Identifier: Apache-2.0
#include "tools/training/physics/column_selection.hpp"

#include "tools/base/numerics/linear_algebra.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

using Eigen::Index;

ColumnChoice select_columns(const Eigen::MatrixXd& psi, double threshold, const Eigen::VectorXd& size) {
    const Eigen::VectorXd norms = psi.colwise().norm().transpose();
    const double root_rows = std::sqrt(static_cast<double>(psi.rows()));
    const Eigen::VectorXd effects =
        (size.size() > 0 ? Eigen::VectorXd(norms.cwiseProduct(size)) : norms) / root_rows;
    const double least = std::max(rounding_share * effects.maxCoeff(), size.size() > 0 ? least_effect : 0);
    Eigen::MatrixXd unit = psi;
    for (Index c = 0; c < psi.cols(); ++c) {
        unit.col(c) *= effects[c] > least ? 1 / norms[c] : 0;
    }
    const auto [r, order] = pivoted_factor(unit);
    ColumnChoice choice;
    for (Index j = 0; j < r.rows(); ++j) {
        if (std::abs(r(j, j)) > threshold) {
            choice.columns.push_back(order[j]);
        }
    }
    std::sort(choice.columns.begin(), choice.columns.end());
    choice.scale.resize(static_cast<Index>(choice.columns.size()));
    for (std::size_t c = 0; c < choice.columns.size(); ++c) {
        choice.scale[static_cast<Index>(c)] = root_rows / norms[choice.columns[c]];
    }
    return choice;
}

} // namespace dfdyn::tools
