// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/identification/base_parameters.hpp"

#include "tools/base/numerics/linear_algebra.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace dfdyn::tools {

namespace {

/// upper limit of the rank threshold, relative to the first diagonal entry
constexpr double rank_limit = 1e-6;
constexpr double relative_rounding = 1e-14; ///< relative; smaller values are zero
constexpr double no_part = 1e-9;            ///< of a combination's coefficients, for columns of equal length

struct Rank {
    Eigen::Index rank = 0;
    double gap = 0;
};

Rank rank_at_largest_drop(const Eigen::VectorXd& diagonal) {
    const double first = diagonal[0];
    Rank best{diagonal.size(), diagonal[diagonal.size() - 1] / (relative_rounding * first)};
    double drop = 0;
    for (Eigen::Index i = 1; i < diagonal.size(); ++i) {
        const double ratio = diagonal[i - 1] / std::max(diagonal[i], relative_rounding * first);
        if (diagonal[i] < rank_limit * first && ratio > drop) {
            drop = ratio;
            best = {i, ratio};
        }
    }
    return best;
}

/// Returns a signed coefficient for the text before a name, as ` + 0.39·`, ` - `; three digits.
std::string coefficient_text(double coefficient) {
    std::string text = coefficient < 0 ? " - " : " + ";
    if (std::abs(std::abs(coefficient) - 1) > 5e-4) {
        char digits[32];
        std::snprintf(digits, sizeof digits, "%.3g·", std::abs(coefficient));
        text += digits;
    }
    return text;
}

} // namespace

BaseParameters find_base_parameters(const Eigen::MatrixXd& regressor) {
    Eigen::VectorXd length = regressor.colwise().norm();
    const double longest = length.maxCoeff();
    BaseParameters base;
    base.combination.resize(0, regressor.cols());
    if (!(longest > 0)) {
        return base;
    }
    // A column of rounding errors only must not be scaled up.
    length = (length.array() > relative_rounding * longest).select(length, longest);
    const auto [r, order] = pivoted_factor(regressor * length.cwiseInverse().asDiagonal());
    const auto [rank, gap] = rank_at_largest_drop(r.diagonal().cwiseAbs());
    const Eigen::MatrixXd scaled =
        r.topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solve(r.topRows(rank));
    std::vector<Eigen::Index> taken(static_cast<std::size_t>(rank));
    std::iota(taken.begin(), taken.end(), 0);
    std::ranges::sort(taken, {}, [&place = order](Eigen::Index i) { return place[i]; });
    base.gap = gap;
    base.combination = Eigen::MatrixXd::Zero(rank, regressor.cols());
    for (Eigen::Index row = 0; row < rank; ++row) {
        const Eigen::Index from = taken[static_cast<std::size_t>(row)];
        base.independent.push_back(order[from]);
        for (Eigen::Index column = 0; column < regressor.cols(); ++column) {
            const double value = column < rank ? (column == from ? 1.0 : 0.0) : scaled(from, column);
            if (std::abs(value) > no_part) {
                base.combination(row, order[column]) = value * length[order[column]] / length[order[from]];
            }
        }
    }
    return base;
}

std::vector<std::string> base_parameter_names(const BaseParameters& base,
                                              const std::vector<std::string>& names) {
    std::vector<std::string> result;
    for (Eigen::Index row = 0; row < base.count(); ++row) {
        const Eigen::Index own = base.independent[static_cast<std::size_t>(row)];
        std::string text = names[static_cast<std::size_t>(own)];
        for (Eigen::Index column = 0; column < base.combination.cols(); ++column) {
            const double coefficient = base.combination(row, column);
            if (column != own && coefficient != 0) {
                text += coefficient_text(coefficient) + names[static_cast<std::size_t>(column)];
            }
        }
        result.push_back(text);
    }
    return result;
}

} // namespace dfdyn::tools
