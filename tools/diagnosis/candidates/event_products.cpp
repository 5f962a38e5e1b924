// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/event_products.hpp"

#include <Eigen/Cholesky>

#include <algorithm>

namespace dfdyn::tools {

namespace {

const Eigen::VectorXd* series_on(const std::vector<EffectColumn>& of, Eigen::Index column,
                                 Eigen::Index output) {
    const auto& parts = of[static_cast<std::size_t>(column)].parts;
    const auto found = std::ranges::find(parts, output, &EffectColumn::Part::output);
    return found == parts.end() ? nullptr : &found->series;
}

} // namespace

std::optional<double> noise_event_threshold(const std::vector<EventWindow>& events) {
    // rank of the reference event, from 0; the threshold is three times its log-evidence
    constexpr std::size_t reference_rank = 3;
    return events.size() > reference_rank ? std::optional(1.5 * events[reference_rank].score) : std::nullopt;
}

Eigen::VectorXd weighted_share(const EffectRegression& regression, const Eigen::VectorXd& series) {
    const Eigen::MatrixXd rows = regression.rows().analyse(series);
    const Eigen::MatrixXd precision = regression.noise().cwiseInverse();
    return (precision.transpose() * rows.cwiseAbs2().rowwise().sum()) / series.squaredNorm();
}

EventProducts::EventProducts(const std::vector<EffectColumn>& of, const Eigen::MatrixXd& weighted,
                             const Eigen::VectorXd& share)
    : moment(Eigen::MatrixXd::Zero(weighted.rows(), std::ssize(of))),
      square(Eigen::MatrixXd::Zero(weighted.rows(), std::ssize(of) * (std::ssize(of) + 1) / 2)),
      columns(std::ssize(of)) {
    for (Eigen::Index output = 0; output < weighted.cols(); ++output) {
        Eigen::Index at = 0;
        for (Eigen::Index i = 0; i < columns; ++i) {
            const Eigen::VectorXd* const one = series_on(of, i, output);
            if (one != nullptr) {
                moment.col(i) += weighted.col(output).cwiseProduct(*one);
            }
            for (Eigen::Index j = 0; j <= i; ++j, ++at) {
                const Eigen::VectorXd* const other = series_on(of, j, output);
                if (one != nullptr && other != nullptr) {
                    square.col(at) += share[output] * one->cwiseProduct(*other);
                }
            }
        }
    }
}

double EventProducts::explained(const Eigen::VectorXd& moments, const Eigen::VectorXd& squares) const {
    Eigen::MatrixXd gram(columns, columns);
    Eigen::Index at = 0;
    for (Eigen::Index i = 0; i < columns; ++i) {
        for (Eigen::Index j = 0; j <= i; ++j, ++at) {
            gram(i, j) = gram(j, i) = squares[at];
        }
    }
    gram.diagonal().array() *= 1 + 1e-6;
    const Eigen::LDLT<Eigen::MatrixXd> factor(gram);
    return factor.isPositive() && gram.trace() > 0 ? moments.dot(factor.solve(moments)) : 0;
}

} // namespace dfdyn::tools
