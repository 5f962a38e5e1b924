// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/search/robust_values.hpp"

#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The regression with the same weight for all frequencies of an output.
struct EvenProblem {
    SearchProblem problem;
    MatrixXd scatter; ///< covariance of the weighted moments for noise with its own spectrum
};

EvenProblem even_problem(const Explanation& at, EffectRegression& regression) {
    const MatrixXd even = at.noise.colwise().mean().replicate(at.noise.rows(), 1);
    std::vector<MatrixXd> precision;
    std::vector<MatrixXd> ones;
    for (Index output = 0; output < regression.outputs(); ++output) {
        precision.push_back(regression.weight(output));
        ones.push_back(MatrixXd::Ones(precision.back().rows(), precision.back().cols()));
    }
    regression.set_noise(even.array().square(), precision);
    EvenProblem result{at.problem, regression.weighed_sums().gram};
    regression.set_noise(even, ones);
    result.problem.sums = regression.weighed_sums();
    for (const NuisanceColumn& nuisance : at.problem.nuisance) {
        result.scatter(nuisance.column, nuisance.column) += 1 / (nuisance.deviation * nuisance.deviation);
    }
    return result;
}

EffectFit even_fit(const EvenProblem& even, const std::vector<ChosenShape>& chosen) {
    EffectFit fit = fit_effects(even.problem, chosen);
    fit.covariance = (fit.covariance * even.scatter(fit.columns, fit.columns) * fit.covariance).eval();
    return fit;
}

/// Returns the numbers of the named effects by the output on which they act. -1: several outputs.
std::map<Index, std::vector<std::size_t>> effects_by_output(const Explanation& at) {
    std::map<Index, std::vector<std::size_t>> result;
    for (std::size_t i = 0; i < at.named_effects().size(); ++i) {
        std::set<Index> outputs;
        for (const EffectColumn& column : at.candidates[at.chosen[i].candidate].columns) {
            for (const EffectColumn::Part& part : column.parts) {
                outputs.insert(part.output);
            }
        }
        result[outputs.size() == 1 ? *outputs.begin() : -1].push_back(i);
    }
    return result;
}

std::vector<Index> columns_of(const Explanation& at, const std::vector<std::size_t>& effects) {
    std::vector<Index> columns;
    for (const std::size_t effect : effects) {
        for (Index column = at.first_column(effect); column < at.first_column(effect + 1); ++column) {
            columns.push_back(column);
        }
    }
    return columns;
}

/// Returns whether noise cannot explain the difference of two fits. `even`: the one with the larger variance.
bool contradict(const EffectFit& fit, const EffectFit& even, const std::vector<Index>& columns) {
    // variances per column, of 1 expected; of 91 outputs of simulated arms with an effect, 3 exceed it
    constexpr double far = 2;
    const VectorXd apart = even.coefficients(columns) - fit.coefficients(columns);
    return apart.dot(even.covariance(columns, columns).ldlt().solve(apart)) >
           far * static_cast<double>(columns.size());
}

/// Returns a lasting effect that `values` do not support: its coefficients are inadmissible, or its evidence
/// is the least and does not pay its price.
std::optional<std::size_t> unsupported(const Explanation& at, const std::vector<std::size_t>& effects) {
    std::optional<std::size_t> result;
    double least = 0;
    for (const std::size_t effect : effects) {
        const ChosenShape& one = at.chosen[effect];
        const Candidate& candidate = at.candidates[one.candidate];
        const double evidence = at.evidence(effect);
        if (candidate.event) {
            continue;
        }
        if (!candidate.shapes[one.shape].allowed(at.coefficients(effect))) {
            return effect;
        }
        if (evidence < least) {
            least = evidence;
            result = effect;
        }
    }
    return result;
}

/// Sets the values. Returns an effect to be removed, if there is one.
std::optional<std::size_t> choose_values(Explanation& at, const EvenProblem& problem) {
    const EffectFit even = even_fit(problem, at.named_effects());
    at.values = at.named;
    for (const auto& [output, effects] : effects_by_output(at)) {
        const std::vector<Index> columns = columns_of(at, effects);
        if (contradict(at.named, even, columns)) {
            at.values.coefficients(columns) = even.coefficients(columns);
            at.values.covariance(columns, columns) = even.covariance(columns, columns);
            if (const auto effect = unsupported(at, effects)) {
                return effect;
            }
        }
    }
    return {};
}

} // namespace

void make_robust(Explanation& at, EffectRegression& regression) {
    const EvenProblem problem = even_problem(at, regression);
    while (const std::optional<std::size_t> effect = choose_values(at, problem)) {
        at.chosen = without(at.chosen, *effect);
        at.fit = fit_effects(at.problem, at.chosen);
        at.named = fit_effects(at.problem, at.named_effects());
    }
}

} // namespace dfdyn::tools
