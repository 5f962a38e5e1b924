// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/search/robust_values.hpp"

#include "tools/diagnosis/search/prune_effects.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns the problem of the named effects alone. Its columns are those of `at.named`, numbered from 0.
SearchProblem problem_of_named(const FittedEffects& at) {
    std::vector<Index> position(static_cast<std::size_t>(at.problem.sums.gram.rows()));
    for (std::size_t i = 0; i < at.named.columns.size(); ++i) {
        position[static_cast<std::size_t>(at.named.columns[i])] = static_cast<Index>(i);
    }
    const auto renumber = [&](Index& column) { column = position[static_cast<std::size_t>(column)]; };
    SearchProblem problem{{}, at.problem.candidates, at.problem.nuisance};
    for (NuisanceColumn& nuisance : problem.nuisance) {
        renumber(nuisance.column);
    }
    for (const ChosenShape& one : at.named_effects()) {
        std::ranges::for_each(problem.candidates[one.candidate].shapes[one.shape].columns, renumber);
    }
    return problem;
}

/// Fits of the named effects. Each output has the weights of its noise, or the same weight for all
/// frequencies.
class Refit {
  public:
    Refit(const FittedEffects& at, EffectRegression& regression)
        : problem_(problem_of_named(at)), by_noise_(sums_of_outputs(at, regression)) {
        const MatrixXd even = at.noise.colwise().mean().replicate(at.noise.rows(), 1);
        std::vector<MatrixXd> precision;
        std::vector<MatrixXd> ones;
        for (Index output = 0; output < regression.outputs(); ++output) {
            precision.push_back(regression.weight(output));
            ones.emplace_back(MatrixXd::Ones(precision.back().rows(), precision.back().cols()));
        }
        regression.set_noise(even, ones);
        evenly_ = sums_of_outputs(at, regression);
        regression.set_noise(even.array().square(), precision);
        scatter_ = sums_of_outputs(at, regression);
    }

    Index outputs() const { return std::ssize(evenly_); }

    /// `even`: per output, whether all frequencies have the same weight.
    EffectFit fit(const std::vector<ChosenShape>& chosen, const std::vector<bool>& even) {
        const Index all = by_noise_.front().gram.rows();
        problem_.sums = WeightedSums::zero(all);
        MatrixXd scatter = MatrixXd::Zero(all, all); // covariance of the moments
        for (std::size_t output = 0; output < even.size(); ++output) {
            const WeightedSums& own = even[output] ? evenly_[output] : by_noise_[output];
            problem_.sums.gram += own.gram;
            problem_.sums.moment += own.moment;
            scatter += even[output] ? scatter_[output].gram : own.gram;
        }
        for (const NuisanceColumn& nuisance : problem_.nuisance) {
            scatter(nuisance.column, nuisance.column) += 1 / (nuisance.deviation * nuisance.deviation);
        }
        EffectFit result = fit_effects(problem_, chosen);
        result.covariance =
            (result.covariance * scatter(result.columns, result.columns) * result.covariance).eval();
        return result;
    }

    /// Returns the positions in a fit of the columns that act on this output alone.
    std::vector<Index> columns_of(const EffectFit& fit, Index output) const {
        std::vector<Index> result;
        for (Index i = 0; i < std::ssize(fit.columns); ++i) {
            const Index column = fit.columns[static_cast<std::size_t>(i)];
            const auto acts = [column](const WeightedSums& one) { return one.gram(column, column) > 0; };
            if (acts(evenly_[static_cast<std::size_t>(output)]) &&
                std::ranges::count_if(evenly_, acts) == 1) {
                result.push_back(i);
            }
        }
        return result;
    }

  private:
    static std::vector<WeightedSums> sums_of_outputs(const FittedEffects& at,
                                                     const EffectRegression& regression) {
        std::vector<WeightedSums> sums;
        for (Index output = 0; output < regression.outputs(); ++output) {
            sums.push_back(regression.sums_of_output(output, at.named.columns));
        }
        return sums;
    }

    SearchProblem problem_;
    std::vector<WeightedSums> by_noise_, evenly_; ///< per output, with these weights
    std::vector<WeightedSums> scatter_;           ///< covariances of the moments of `evenly_`
};

/// Returns whether noise cannot explain the difference of two fits. `even`: the one with the larger variance.
bool contradict(const EffectFit& fit, const EffectFit& even, const std::vector<Index>& columns) {
    // the squared distance per column, at most 1 on average if the effects are right; of 91 outputs of
    // simulated arms (panel of seeds 331000 to 331119) 3 exceed 2, of the six of a real TX40 all
    constexpr double max_mean_square = 2;
    const VectorXd apart = even.coefficients(columns) - fit.coefficients(columns);
    return apart.dot(even.covariance(columns, columns).ldlt().solve(apart)) >
           max_mean_square * static_cast<double>(columns.size());
}

/// Returns a persistent effect on the `inexact` outputs that `values` do not support: its coefficients are
/// inadmissible, or its log-evidence is the smallest and below its prior penalty.
std::optional<std::size_t> unsupported(const FittedEffects& at) {
    std::optional<std::size_t> result;
    double least = 0;
    for (std::size_t effect = 0; effect < at.named_effects().size(); ++effect) {
        const ChosenShape& one = at.chosen[effect];
        const Candidate& candidate = at.candidates[one.candidate];
        const EffectShape& shape = candidate.shapes[one.shape];
        const auto on_inexact = [&](const EffectColumn::Part& part) {
            return at.inexact[static_cast<std::size_t>(part.output)];
        };
        if (candidate.event ||
            !std::ranges::any_of(candidate.columns[shape.columns.front()].parts, on_inexact)) {
            continue;
        }
        if (!shape.allowed(at.coefficients(effect))) {
            return effect;
        }
        if (const double evidence = at.evidence(effect); evidence < least) {
            least = evidence;
            result = effect;
        }
    }
    return result;
}

/// Sets the values. Returns an effect to be removed, if there is one.
std::optional<std::size_t> choose_values(FittedEffects& at, Refit& refit) {
    const auto outputs = static_cast<std::size_t>(refit.outputs());
    const EffectFit all_even = refit.fit(at.named_effects(), std::vector<bool>(outputs, true));
    at.inexact.clear();
    for (Index output = 0; output < refit.outputs(); ++output) {
        at.inexact.push_back(contradict(at.named, all_even, refit.columns_of(all_even, output)));
    }
    at.values = refit.fit(at.named_effects(), at.inexact);
    at.values.columns = at.named.columns;
    return unsupported(at);
}

} // namespace

void make_robust(FittedEffects& at, EffectRegression& regression) {
    Refit refit(at, regression);
    while (const std::optional<std::size_t> effect = choose_values(at, refit)) {
        at.chosen = without(at.chosen, *effect);
        fit_named(at);
    }
}

} // namespace dfdyn::tools
