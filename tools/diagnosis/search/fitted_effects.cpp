// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/search/fitted_effects.hpp"

#include <algorithm>
#include <iterator>

namespace dfdyn::tools {

namespace {

void accumulate(Eigen::MatrixXd& sum, double coefficient, const EffectColumn& column) {
    for (const EffectColumn::Part& part : column.parts) {
        sum.col(part.output) += coefficient * part.series;
    }
}

} // namespace

double FittedEffects::nuisance_factor(Eigen::Index number) const {
    constexpr double least = 0.1;
    const double factor = 1 + values.coefficients[number];
    return factor > least ? factor : 1;
}

Eigen::Index FittedEffects::first_column(std::size_t chosen_index) const {
    auto first = static_cast<Eigen::Index>(problem.nuisance.size());
    for (std::size_t i = 0; i < chosen_index; ++i) {
        first +=
            static_cast<Eigen::Index>(candidates[chosen[i].candidate].shapes[chosen[i].shape].columns.size());
    }
    return first;
}

Eigen::VectorXd FittedEffects::coefficients(std::size_t chosen_index) const {
    const Eigen::Index first = first_column(chosen_index);
    return values.coefficients.segment(first, first_column(chosen_index + 1) - first);
}

Eigen::MatrixXd FittedEffects::covariance(std::size_t chosen_index) const {
    const Eigen::Index first = first_column(chosen_index);
    const Eigen::Index count = first_column(chosen_index + 1) - first;
    return values.covariance.block(first, first, count, count);
}

double FittedEffects::evidence(std::size_t chosen_index) const {
    const Eigen::VectorXd own = coefficients(chosen_index);
    return evidence_of(problem, chosen[chosen_index], own.dot(covariance(chosen_index).ldlt().solve(own)));
}

std::vector<ChosenShape> FittedEffects::named_effects() const {
    std::vector<ChosenShape> result;
    std::ranges::copy_if(chosen, std::back_inserter(result),
                         [this](const ChosenShape& one) { return candidates[one.candidate].named(); });
    return result;
}

Eigen::MatrixXd FittedEffects::of_fit(const DiagnosisSignals& signals, const EffectFit& of,
                                      const std::function<bool(const Candidate&)>& wanted) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(signals.rows(), signals.outputs());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const Candidate& candidate = candidates[chosen[i].candidate];
        if (!wanted(candidate)) {
            continue;
        }
        const std::vector<std::size_t>& columns = candidate.shapes[chosen[i].shape].columns;
        const Eigen::Index first = first_column(i);
        for (std::size_t k = 0; k < columns.size(); ++k) {
            accumulate(sum, of.coefficients[first + static_cast<Eigen::Index>(k)],
                       candidate.columns[columns[k]]);
        }
    }
    return sum;
}

Eigen::MatrixXd FittedEffects::contribution_of(const DiagnosisSignals& signals,
                                               const std::function<bool(const Candidate&)>& wanted) const {
    return of_fit(signals, fit, wanted);
}

Eigen::MatrixXd FittedEffects::with_nuisance(const DiagnosisSignals& signals, const EffectFit& of,
                                             const std::function<bool(const Candidate&)>& wanted) const {
    Eigen::MatrixXd sum = of_fit(signals, of, wanted);
    for (std::size_t i = 0; i < nuisance.size(); ++i) {
        accumulate(sum, of.coefficients[static_cast<Eigen::Index>(i)], nuisance[i]);
    }
    return sum;
}

Eigen::MatrixXd FittedEffects::total_contribution(const DiagnosisSignals& signals) const {
    return with_nuisance(signals, fit, [](const Candidate&) { return true; });
}

Eigen::MatrixXd FittedEffects::reported_contribution(const DiagnosisSignals& signals) const {
    return with_nuisance(signals, values, &Candidate::named);
}

} // namespace dfdyn::tools
