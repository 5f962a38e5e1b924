// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/search/effect_search.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double min_evidence_increase = 1e-6; ///< of the log-evidence: smaller differences are ignored
constexpr double least_independent = 1e-3;     ///< share of a column that is independent of the others
/// minimum share of a column, relative to its rest after the nuisance columns
constexpr double least_beyond_nuisance = 0.1;
constexpr std::size_t most_effects = 48;

const SearchCandidate::Shape& shape_of(const SearchProblem& problem, const ChosenShape& chosen) {
    return problem.candidates[chosen.candidate].shapes[chosen.shape];
}

/// Negative logarithm of the Occam factor of coefficients that explain a sum of squares `explained`. The
/// prior is uniform in the logarithm of their joint size over `orders` (of e), and uniform in direction.
double occam_factor_of(double count, double explained) {
    constexpr double orders = 7; // from a twentieth to fifty times the smallest size that can be detected
    const double size = std::sqrt(std::max(explained, 1.0));
    const double sphere = std::log(2.0) + count / 2 * std::log(std::numbers::pi) - std::lgamma(count / 2);
    return std::log(orders) + sphere + count * std::log(size) - count / 2 * std::log(2 * std::numbers::pi);
}

/// Prior penalty of a candidate: for the number of candidates and shapes, and the Occam factor of its
/// coefficients.
double prior_penalty(const SearchProblem& problem, const ChosenShape& chosen, double explained) {
    const SearchCandidate& candidate = problem.candidates[chosen.candidate];
    const SearchCandidate::Shape& shape = candidate.shapes[chosen.shape];
    const double parameters = static_cast<double>(shape.columns.size()) - 0.5 * shape.bounded_count;
    return candidate.evidence_offset +
           std::log(candidate.candidates_of_class * static_cast<double>(candidate.shapes.size()) *
                    candidate.prior_trials) +
           occam_factor_of(parameters, explained);
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

/// Matrix of a model's normal equations, with the priors of the nuisance parameters.
Eigen::MatrixXd system_of(const SearchProblem& problem, const std::vector<Eigen::Index>& columns) {
    Eigen::MatrixXd system = problem.sums.gram(columns, columns);
    for (std::size_t i = 0; i < problem.nuisance.size(); ++i) {
        const double deviation = problem.nuisance[i].deviation;
        system(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) += 1 / (deviation * deviation);
    }
    system.diagonal() *= 1 + 1e-12;
    return system;
}

/// Negative logarithm of the Occam factor of the nuisance parameters: the logarithm of the ratio of their
/// prior and posterior volumes, each for normal distributions.
double nuisance_occam_factor(const SearchProblem& problem, const Eigen::MatrixXd& system) {
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

/// Prior penalty of the nuisance coefficients: half the sum of their squares in units of their standard
/// deviation.
double nuisance_prior_penalty(const SearchProblem& problem, const Eigen::VectorXd& coefficients) {
    double result = 0;
    for (std::size_t i = 0; i < problem.nuisance.size(); ++i) {
        const double deviations = coefficients[static_cast<Eigen::Index>(i)] / problem.nuisance[i].deviation;
        result += 0.5 * deviations * deviations;
    }
    return result;
}

/// Sum of squares that a shape explains in addition to a model. `left` and `moment`: products of the shape's
/// columns with each other and with the target, after projection on the complement of the model. Returns
/// minus infinity if the coefficients are not admissible or the columns are almost dependent on the model.
double explained_by(const SearchCandidate::Shape& shape, const Eigen::VectorXd& own,
                    const Eigen::MatrixXd& left, const Eigen::VectorXd& moment) {
    constexpr double inadmissible = -std::numeric_limits<double>::infinity();
    if ((left.diagonal().array() <= least_independent * own.array()).any()) {
        return inadmissible;
    }
    const Eigen::LDLT<Eigen::MatrixXd> factor(left);
    if (!(factor.vectorD().array() > 1e-4 * left.diagonal().minCoeff()).all()) {
        return inadmissible;
    }
    const Eigen::VectorXd coefficients = factor.solve(moment);
    if (shape.allowed(coefficients)) {
        return coefficients.dot(moment);
    }
    if (!shape.nearest) {
        return inadmissible;
    }
    const Eigen::VectorXd nearest = shape.nearest(left, moment);
    return shape.allowed(nearest) ? 2 * nearest.dot(moment) - nearest.dot(left * nearest) : inadmissible;
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
    if (fit.allowed && fit.score > best.score + min_evidence_increase) {
        best = {chosen, fit.score};
    }
}

/// Replaces `best` by the best model with one of the `ranked` candidates added to `chosen`: of the first
/// three or, if none is better, the next one that is. Each may give another effect an inadmissible sign.
void keep_best_addition(Step& best, const SearchProblem& problem, const std::vector<ChosenShape>& chosen,
                        const std::vector<Replacement>& ranked) {
    constexpr std::size_t always_tried = 3;
    constexpr std::size_t most_tried = 24;
    const double before = best.score;
    for (std::size_t i = 0; i < std::min(most_tried, ranked.size()) && ranked[i].score > best.score; ++i) {
        if (i >= always_tried && best.score > before) {
            break;
        }
        std::vector<ChosenShape> more = chosen;
        more.push_back(ranked[i].with);
        keep_best(best, problem, more);
    }
}

/// Replaces `best` by the best model with one effect in place of two of the `chosen`: one that may be half of
/// it is removed, the other exchanged.
void keep_best_in_place_of_two(Step& best, const SearchProblem& problem,
                               const std::vector<ChosenShape>& chosen) {
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        if (!problem.candidates[chosen[i].candidate].may_be_half) {
            continue;
        }
        const std::vector<ChosenShape> fewer = without(chosen, i);
        const Neighbours near(problem, fewer);
        for (std::size_t k = 0; k < fewer.size(); ++k) {
            keep_best_addition(best, problem, without(fewer, k), near.exchanges(k));
        }
    }
}

} // namespace

std::vector<ChosenShape> without(std::vector<ChosenShape> chosen, std::size_t index) {
    chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(index));
    return chosen;
}

Eigen::VectorXd EffectFit::of_all(Eigen::Index all) const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(all);
    result(columns) = coefficients;
    return result;
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
    fit.score = 0.5 * fit.explained - nuisance_occam_factor(problem, system);
    auto at = static_cast<Eigen::Index>(problem.nuisance.size());
    for (const ChosenShape& one : chosen) {
        const SearchCandidate::Shape& shape = shape_of(problem, one);
        const auto count = static_cast<Eigen::Index>(shape.columns.size());
        fit.allowed = fit.allowed && shape.allowed(fit.coefficients.segment(at, count));
        const Eigen::VectorXd own = fit.coefficients.segment(at, count);
        fit.score -=
            prior_penalty(problem, one, own.dot(fit.covariance.block(at, at, count, count).llt().solve(own)));
        at += count;
    }
    return fit;
}

double evidence_of(const SearchProblem& problem, const ChosenShape& chosen, double explained) {
    return 0.5 * explained - prior_penalty(problem, chosen, explained);
}

double held_out_score(const SearchProblem& problem, const std::vector<WeightedSums>& blocks,
                      const std::vector<ChosenShape>& chosen) {
    const std::vector<Eigen::Index> columns = columns_of(problem, chosen);
    const Eigen::MatrixXd system = system_of(problem, columns);
    const Eigen::VectorXd moment = problem.sums.moment(columns);
    double score = -nuisance_prior_penalty(problem, system.ldlt().solve(moment));
    for (const WeightedSums& block : blocks) {
        const WeightedSums own{block.gram(columns, columns), block.moment(columns)};
        score += held_out_reduction(system - own.gram, moment - own.moment, own);
    }
    return score;
}

Neighbours::Neighbours(const SearchProblem& problem, const std::vector<ChosenShape>& chosen)
    : problem_(problem), chosen_(chosen), columns_(columns_of(problem, chosen)) {
    const Eigen::MatrixXd system = system_of(problem, columns_);
    const Eigen::LLT<Eigen::MatrixXd> factor(system);
    const Eigen::VectorXd moment = problem.sums.moment(columns_);
    coefficients_ = factor.solve(moment);
    covariance_ = factor.solve(Eigen::MatrixXd::Identity(system.rows(), system.cols()));
    products_ = problem.sums.gram(columns_, Eigen::all);
    const Eigen::MatrixXd seen = factor.matrixL().solve(products_);
    const Eigen::VectorXd known = factor.matrixL().solve(moment);
    score_ = 0.5 * coefficients_.dot(moment) - nuisance_occam_factor(problem, system);
    auto first = static_cast<Eigen::Index>(problem.nuisance.size());
    for (const ChosenShape& one : chosen) {
        first_.push_back(first);
        first += std::ssize(shape_of(problem, one).columns);
    }
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        score_ -= prior_penalty(problem, chosen[i], returned(i).moment.squaredNorm());
    }
    for (const SearchCandidate& candidate : problem.candidates) {
        for (const SearchCandidate::Shape& shape : candidate.shapes) {
            const Eigen::MatrixXd own = problem.sums.gram(shape.columns, shape.columns);
            const Eigen::MatrixXd part = seen(Eigen::all, shape.columns);
            const Eigen::VectorXd by_nuisance =
                part.topRows(std::ssize(problem.nuisance)).colwise().squaredNorm();
            beyond_.push_back(
                {(own.diagonal() - by_nuisance).cwiseMax(least_beyond_nuisance * own.diagonal()),
                 own - part.transpose() * part,
                 problem.sums.moment(shape.columns) - part.transpose() * known});
        }
    }
}

Neighbours::Returned Neighbours::returned(std::size_t index) const {
    const Eigen::Index first = first_[index];
    const auto count = std::ssize(shape_of(problem_, chosen_[index]).columns);
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance_.block(first, first, count, count));
    return {factor.matrixL().solve(covariance_.middleRows(first, count) * products_),
            factor.matrixL().solve(coefficients_.segment(first, count))};
}

double Neighbours::score_without(std::size_t index) const {
    const double explained = returned(index).moment.squaredNorm();
    return score_ + prior_penalty(problem_, chosen_[index], explained) - 0.5 * explained;
}

std::vector<Replacement> Neighbours::additions() const {
    const Returned nothing{Eigen::MatrixXd(0, products_.cols()), Eigen::VectorXd(0)};
    return ranked(chosen_, score_, nothing);
}

std::vector<Replacement> Neighbours::exchanges(std::size_t index) const {
    const Returned what = returned(index);
    return ranked(without(chosen_, index), score_without(index), what);
}

std::vector<Replacement> Neighbours::ranked(const std::vector<ChosenShape>& chosen, double base,
                                            const Returned& returned) const {
    std::vector<Replacement> result;
    auto beyond = beyond_.begin();
    for (std::size_t index = 0; index < problem_.candidates.size(); ++index) {
        const std::vector<SearchCandidate::Shape>& shapes = problem_.candidates[index].shapes;
        const auto first = beyond;
        beyond += std::ssize(shapes);
        if (std::any_of(chosen.begin(), chosen.end(), [&](const ChosenShape& one) {
                return excludes(problem_.candidates, one.candidate, index);
            })) {
            continue;
        }
        Replacement best{{}, -std::numeric_limits<double>::infinity()};
        for (std::size_t shape = 0; shape < shapes.size(); ++shape) {
            const Beyond& left = first[static_cast<std::ptrdiff_t>(shape)];
            const Eigen::MatrixXd back = returned.columns(Eigen::all, shapes[shape].columns);
            const double explained =
                explained_by(shapes[shape], left.own, left.left + back.transpose() * back,
                             left.moment + back.transpose() * returned.moment);
            const ChosenShape one{index, shape};
            const double score = base + 0.5 * explained - prior_penalty(problem_, one, explained);
            if (explained > 0 && score > best.score) {
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
        const Neighbours near(problem, at.chosen);
        Step best = at;
        if (at.chosen.size() < most_effects) {
            keep_best_addition(best, problem, at.chosen, near.additions());
        }
        if (best.chosen.size() <=
            at.chosen.size()) { // no addition helps: compare each chosen effect with its alternatives
            for (std::size_t i = 0; i < at.chosen.size(); ++i) {
                const std::vector<ChosenShape> fewer = without(at.chosen, i);
                if (near.score_without(i) > best.score) {
                    keep_best(best, problem, fewer);
                }
                keep_best_addition(best, problem, fewer, near.exchanges(i));
            }
        }
        const auto improved = [&] { return best.score > at.score + min_evidence_increase; };
        if (!improved()) {
            keep_best_in_place_of_two(best, problem, at.chosen);
        }
        if (!improved()) {
            break;
        }
        at = best;
    }
    return at.chosen;
}

} // namespace dfdyn::tools
