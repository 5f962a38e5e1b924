// SPDX-License-Identifier: Apache-2.0
// Models of the residual on an arm's first output, each with a few candidates.
#pragma once

#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/search/fitted_effects.hpp"

#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tests {

inline Eigen::VectorXd random_series(const tools::DiagnosisSignals& signals, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    return Eigen::VectorXd::NullaryExpr(signals.rows(), [&] { return normal(engine); });
}

inline tools::Candidate of_one_column(const std::string& effect, const std::string& where,
                                      const Eigen::VectorXd& series) {
    tools::Candidate candidate =
        tools::single_column(where, tools::on_output(0, series), tools::is_anything, {"level", "N·m"});
    candidate.effect = effect;
    return candidate;
}

/// A fitted model of candidates on the first output. The first `chosen` candidates are in the model, each in
/// its first shape; the noise has a variance of 1. There is no friction that could build up.
inline tools::FittedEffects fitted_effects_of(const std::vector<tools::Candidate>& candidates,
                                              std::size_t chosen, const Eigen::VectorXd& unexplained) {
    Eigen::MatrixXd columns(unexplained.size(), 0);
    tools::FittedEffects fitted_effects;
    fitted_effects.candidates = candidates;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const Eigen::Index first = columns.cols();
        columns.conservativeResize(Eigen::NoChange, first + std::ssize(candidates[i].columns));
        for (std::size_t k = 0; k < candidates[i].columns.size(); ++k) {
            columns.col(first + static_cast<Eigen::Index>(k)) = candidates[i].columns[k].parts.front().series;
        }
        tools::SearchCandidate candidate;
        for (const tools::EffectShape& shape : candidates[i].shapes) {
            candidate.shapes.push_back(
                {{first + static_cast<Eigen::Index>(shape.columns.front())}, shape.allowed});
        }
        fitted_effects.problem.candidates.push_back(std::move(candidate));
        if (i < chosen) {
            fitted_effects.chosen.push_back({i, 0});
        }
    }
    fitted_effects.problem.sums = {columns.transpose() * columns, columns.transpose() * unexplained};
    fitted_effects.fit = tools::fit_effects(fitted_effects.problem, fitted_effects.chosen);
    fitted_effects.named = tools::fit_effects(fitted_effects.problem, fitted_effects.named_effects());
    fitted_effects.values = fitted_effects.named;
    fitted_effects.margin_with_lags.assign(chosen, std::numeric_limits<double>::infinity());
    return fitted_effects;
}

} // namespace dfdyn::tests
