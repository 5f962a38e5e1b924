// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/effect_search.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double least_gain = 1e-6;        ///< of the evidence: below it nothing changes
constexpr double least_independent = 1e-3; ///< share of a column that the others must leave
constexpr std::size_t most_effects = 48;

const SearchCandidate::Shape& shape_of(const SearchProblem& problem, const ChosenShape& chosen) {
    return problem.candidates[chosen.candidate].shapes[chosen.shape];
}

/// What a candidate costs for being one of many, of many shapes, with so many coefficients.
double price(const SearchProblem& problem, const ChosenShape& chosen) {
    const SearchCandidate& candidate = problem.candidates[chosen.candidate];
    const SearchCandidate::Shape& shape = candidate.shapes[chosen.shape];
    const double parameters = static_cast<double>(shape.columns.size()) - 0.5 * shape.bounded;
    return candidate.extra_price +
           std::log(candidate.rivals * static_cast<double>(candidate.shapes.size()) * candidate.tried) +
           0.5 * parameters * std::log1p(candidate.rows);
}

std::vector<Eigen::Index> columns_of(const SearchProblem& problem, const std::vector<ChosenShape>& chosen) {
    std::vector<Eigen::Index> columns;
    for (const NuisanceColumn& nuisance : problem.nuisance) {
        columns.push_back(nuisance.column);
    }
    for (const ChosenShape& one : chosen) {
        const std::vector<Eigen::Index>& own = shape_of(problem, one).columns;
        columns.insert(columns.end(), own.begin(), own.end());
    }
    return columns;
}

/// The normal equations' matrix of a model, with the nuisance's priors.
Eigen::MatrixXd system_of(const SearchProblem& problem, const std::vector<Eigen::Index>& columns) {
    Eigen::MatrixXd system = problem.sums.gram(columns, columns);
    for (std::size_t i = 0; i < problem.nuisance.size(); ++i) {
        const double deviation = problem.nuisance[i].deviation;
        system(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) += 1 / (deviation * deviation);
    }
    system.diagonal() *= 1 + 1e-12;
    return system;
}

double nuisance_price(const SearchProblem& problem, const Eigen::MatrixXd& system) {
    const auto count = static_cast<Eigen::Index>(problem.nuisance.size());
    if (count == 0) {
        return 0;
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(system.topLeftCorner(count, count));
    double result = factor.matrixLLT().diagonal().array().log().sum();
    for (const NuisanceColumn& nuisance : problem.nuisance) {
        result += std::log(nuisance.deviation);
    }
    return result;
}

/// A model's factor, with all columns of the problem projected out of it.
struct Projection {
    Eigen::MatrixXd seen;  ///< model x p
    Eigen::VectorXd known; ///< model
};

Projection project(const SearchProblem& problem, const std::vector<Eigen::Index>& columns) {
    const Eigen::LLT<Eigen::MatrixXd> factor(system_of(problem, columns));
    return {factor.matrixL().solve(problem.sums.gram(columns, Eigen::all)),
            factor.matrixL().solve(problem.sums.moment(columns))};
}

/// What a shape explains beyond the model; negative infinity when it may not, or the model leaves nothing of
/// it.
double gain_of(const SearchProblem& problem, const Projection& projection,
               const SearchCandidate::Shape& shape) {
    constexpr double never = -std::numeric_limits<double>::infinity();
    const Eigen::MatrixXd seen = projection.seen(Eigen::all, shape.columns);
    const Eigen::MatrixXd own = problem.sums.gram(shape.columns, shape.columns);
    const Eigen::MatrixXd left = own - seen.transpose() * seen;
    const Eigen::VectorXd moment = problem.sums.moment(shape.columns) - seen.transpose() * projection.known;
    const Eigen::LDLT<Eigen::MatrixXd> factor(left);
    if ((left.diagonal().array() <= least_independent * own.diagonal().array()).any() ||
        !(factor.vectorD().array() > 1e-4 * left.diagonal().minCoeff()).all()) {
        return never;
    }
    const Eigen::VectorXd coefficients = factor.solve(moment);
    return shape.allowed(coefficients) ? coefficients.dot(moment) : never;
}

bool excludes(const std::vector<SearchCandidate>& candidates, std::size_t one, std::size_t other) {
    return one == other ||
           (candidates[one].family != 0 && candidates[one].family == candidates[other].family);
}

struct Step {
    std::vector<ChosenShape> chosen;
    double score;
};

void keep_best(Step& best, const SearchProblem& problem, const std::vector<ChosenShape>& chosen) {
    const EffectFit fit = fit_effects(problem, chosen);
    if (fit.allowed && fit.score > best.score + least_gain) {
        best = {chosen, fit.score};
    }
}

/// The best of `chosen` with one more.
void try_addition(Step& best, const SearchProblem& problem, const std::vector<ChosenShape>& chosen) {
    constexpr std::size_t tried = 3; // the first may give another effect a sign that it may not have
    const std::vector<Replacement> ranked = additions(problem, chosen);
    for (std::size_t i = 0; i < std::min(tried, ranked.size()) && ranked[i].score > best.score; ++i) {
        std::vector<ChosenShape> more = chosen;
        more.push_back(ranked[i].with);
        keep_best(best, problem, more);
    }
}

} // namespace

std::vector<ChosenShape> without(std::vector<ChosenShape> chosen, std::size_t index) {
    chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(index));
    return chosen;
}

EffectFit fit_effects(const SearchProblem& problem, const std::vector<ChosenShape>& chosen) {
    EffectFit fit;
    fit.columns = columns_of(problem, chosen);
    const Eigen::MatrixXd system = system_of(problem, fit.columns);
    const Eigen::LDLT<Eigen::MatrixXd> factor(system);
    const Eigen::VectorXd moment = problem.sums.moment(fit.columns);
    fit.coefficients = factor.solve(moment);
    fit.covariance = factor.solve(Eigen::MatrixXd::Identity(system.rows(), system.cols()));
    fit.explained = fit.coefficients.dot(moment);
    fit.score = 0.5 * fit.explained - nuisance_price(problem, system);
    auto at = static_cast<Eigen::Index>(problem.nuisance.size());
    for (const ChosenShape& one : chosen) {
        const SearchCandidate::Shape& shape = shape_of(problem, one);
        const auto count = static_cast<Eigen::Index>(shape.columns.size());
        fit.allowed = fit.allowed && shape.allowed(fit.coefficients.segment(at, count));
        fit.score -= price(problem, one);
        at += count;
    }
    return fit;
}

double held_out_score(const SearchProblem& problem, const std::vector<WeighedSums>& blocks,
                      const std::vector<ChosenShape>& chosen) {
    const std::vector<Eigen::Index> columns = columns_of(problem, chosen);
    const Eigen::MatrixXd system = system_of(problem, columns);
    const Eigen::VectorXd moment = problem.sums.moment(columns);
    double score = 0;
    for (const WeighedSums& block : blocks) {
        const Eigen::MatrixXd own = block.gram(columns, columns);
        const Eigen::VectorXd own_moment = block.moment(columns);
        const Eigen::VectorXd others = (system - own).ldlt().solve(moment - own_moment);
        score += others.dot(own_moment) - 0.5 * others.dot(own * others);
    }
    return score;
}

std::vector<Replacement> additions(const SearchProblem& problem, const std::vector<ChosenShape>& chosen) {
    const EffectFit base = fit_effects(problem, chosen);
    const Projection projection = project(problem, base.columns);
    std::vector<Replacement> result;
    for (std::size_t index = 0; index < problem.candidates.size(); ++index) {
        if (std::any_of(chosen.begin(), chosen.end(), [&](const ChosenShape& one) {
                return excludes(problem.candidates, one.candidate, index);
            })) {
            continue;
        }
        Replacement best{{}, -std::numeric_limits<double>::infinity()};
        for (std::size_t shape = 0; shape < problem.candidates[index].shapes.size(); ++shape) {
            const ChosenShape one{index, shape};
            const double score =
                base.score + 0.5 * gain_of(problem, projection, shape_of(problem, one)) - price(problem, one);
            if (score > best.score) {
                best = {one, score};
            }
        }
        if (std::isfinite(best.score)) {
            result.push_back(best);
        }
    }
    std::ranges::sort(result, std::greater<>{}, &Replacement::score);
    return result;
}

std::vector<ChosenShape> search_effects(const SearchProblem& problem, std::vector<ChosenShape> start) {
    Step at{{}, fit_effects(problem, {}).score};
    keep_best(at, problem, start);
    for (int round = 0; round < 100; ++round) {
        Step best = at;
        if (at.chosen.size() < most_effects) {
            try_addition(best, problem, at.chosen);
        }
        if (best.chosen.size() <=
            at.chosen.size()) { // nothing to add: is what there is the best of its kind?
            for (std::size_t i = 0; i < at.chosen.size(); ++i) {
                const std::vector<ChosenShape> fewer = without(at.chosen, i);
                keep_best(best, problem, fewer);
                try_addition(best, problem, fewer);
            }
        }
        if (!(best.score > at.score + least_gain)) {
            break;
        }
        at = best;
    }
    return at.chosen;
}

} // namespace dfdyn::tools
