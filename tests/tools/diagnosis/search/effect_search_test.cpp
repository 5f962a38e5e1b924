// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/diagnosis/search/effect_search.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <random>

namespace effect_search_test {

using namespace dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index rows = 2000;

MatrixXd random_columns(Index count, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    MatrixXd columns(rows, count);
    for (Index i = 0; i < columns.size(); ++i) {
        columns.data()[i] = normal(engine);
    }
    return columns;
}

bool anything(const VectorXd& /*coefficients*/) { return true; }
bool positive(const VectorXd& coefficients) { return (coefficients.array() > 0).all(); }

/// A search problem with one candidate per column.
SearchProblem problem_of(const MatrixXd& columns, const VectorXd& target) {
    SearchProblem problem;
    problem.sums = {columns.transpose() * columns, columns.transpose() * target};
    for (Index column = 0; column < columns.cols(); ++column) {
        SearchCandidate candidate;
        candidate.shapes.push_back({{column}, anything});
        candidate.candidates_of_class = static_cast<double>(columns.cols());
        problem.candidates.push_back(candidate);
    }
    return problem;
}

std::vector<std::size_t> found(const SearchProblem& problem) {
    std::vector<std::size_t> result;
    for (const ChosenShape& one : search_effects(problem, {})) {
        result.push_back(one.candidate);
    }
    std::ranges::sort(result);
    return result;
}

TEST_CASE("the search finds exactly the planted effects with their coefficients and nothing in noise") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 20; ++trial) {
        const MatrixXd columns = random_columns(60, engine);
        const VectorXd noise = random_columns(1, engine);
        CHECK(found(problem_of(columns, noise)).empty());
        const VectorXd target = 0.5 * columns.col(7) - 0.2 * columns.col(31) + noise;
        const SearchProblem problem = problem_of(columns, target);
        const std::vector<ChosenShape> chosen = search_effects(problem, {});
        CHECK(found(problem) == std::vector<std::size_t>{7, 31});
        const EffectFit fit = fit_effects(problem, chosen);
        const VectorXd exact = least_squares(columns(Eigen::all, fit.columns), target);
        CHECK((fit.coefficients - exact).cwiseAbs().maxCoeff() < 1e-8);
    }
}

TEST_CASE("the scores of neighbouring models equal those of the fitted models") {
    DFDYN_SEEDED_ENGINE(engine);
    const MatrixXd columns = random_columns(12, engine);
    const VectorXd target = 0.5 * columns.col(2) + 0.4 * columns.col(3) - 0.3 * columns.col(7) +
                            0.2 * columns.col(8) + random_columns(1, engine);
    SearchProblem problem = problem_of(columns, target);
    problem.candidates[2].shapes = {{{2, 3}, anything}, {{2}, anything}};
    problem.nuisance = {{11, 0.1}};
    problem.candidates.resize(11);
    const std::vector<ChosenShape> chosen{{2, 0}, {7, 0}};
    const Neighbours near(problem, chosen);
    CHECK(near.score() == Approx(fit_effects(problem, chosen).score));
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const std::vector<ChosenShape> fewer = without(chosen, i);
        // Priors depend on what each effect explains; independent other effects change that very little.
        CHECK(near.score_without(i) == Approx(fit_effects(problem, fewer).score).margin(0.5));
        for (const Replacement& other : near.exchanges(i)) {
            std::vector<ChosenShape> exchanged = fewer;
            exchanged.push_back(other.with);
            CHECK(other.score == Approx(fit_effects(problem, exchanged).score).margin(0.5));
        }
    }
    for (const Replacement& one : near.additions()) {
        std::vector<ChosenShape> more = chosen;
        more.push_back(one.with);
        CHECK(one.score == Approx(fit_effects(problem, more).score).margin(0.5));
    }
}

TEST_CASE("a column that resembles the sum of two others is replaced by them") {
    DFDYN_SEEDED_ENGINE(engine);
    MatrixXd columns = random_columns(10, engine);
    columns.col(9) += 3 * columns.col(0) + 3 * columns.col(1); // explains most of the target, but not all
    const VectorXd target = 2 * columns.col(0) + 2 * columns.col(1) + random_columns(1, engine);
    CHECK(found(problem_of(columns, target)) == std::vector<std::size_t>{0, 1});
}

TEST_CASE(
    "two chosen effects are replaced by one that does the same, if one of them may be half of another") {
    DFDYN_SEEDED_ENGINE(engine);
    MatrixXd columns = random_columns(5, engine);
    columns.col(4) = columns.middleCols(1, 3).rowwise().sum();
    const VectorXd target = columns.col(0) + columns.col(4) + random_columns(1, engine);
    SearchProblem problem = problem_of(columns, target);
    problem.candidates[0].shapes.push_back({{0, 1, 2, 3}, anything});
    problem.candidates[1] = problem.candidates[4];
    problem.candidates[1].evidence_offset = 20; // the whole effect is more probable
    problem.candidates.resize(2);
    const std::vector<ChosenShape> halves{{0, 0}, {1, 0}};
    CHECK(search_effects(problem, halves) == halves);
    problem.candidates[1].may_be_half = true;
    CHECK(search_effects(problem, halves) == std::vector<ChosenShape>{{0, 1}});
}

TEST_CASE("the search chooses at most one effect of a family and only allowed coefficients") {
    DFDYN_SEEDED_ENGINE(engine);
    const MatrixXd columns = random_columns(4, engine);
    const VectorXd target =
        columns.col(0) + 0.8 * columns.col(1) - columns.col(2) + random_columns(1, engine);
    SearchProblem problem = problem_of(columns, target);
    problem.candidates[0].family = problem.candidates[1].family = 1;
    problem.candidates[2].shapes[0].allowed = positive;
    CHECK(found(problem) == std::vector<std::size_t>{0});
}

TEST_CASE("an effect is found behind many candidates that would give another one an inadmissible sign") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr Index copies = 5;
    const Eigen::HouseholderQR<MatrixXd> factor(random_columns(3 + copies, engine));
    const MatrixXd exact = std::sqrt(rows) * (factor.householderQ() * MatrixXd::Identity(rows, 3 + copies));
    MatrixXd columns(rows, 2 + copies);
    columns.col(0) = exact.col(0);
    columns.col(1) = exact.col(2);
    for (Index copy = 2; copy < columns.cols(); ++copy) { // in a model with one, column 0 is negative
        columns.col(copy) = exact.col(0) + 0.5 * exact.col(1) + 0.01 * exact.col(1 + copy);
    }
    SearchProblem problem = problem_of(columns, 1.5 * exact.col(0) + exact.col(1) + 0.16 * exact.col(2));
    problem.candidates[0].shapes.front().allowed = positive;
    for (std::size_t copy = 2; copy < problem.candidates.size(); ++copy) {
        problem.candidates[copy].evidence_offset = 955; // explains 950 more than column 0
    }
    CHECK(found(problem) == std::vector<std::size_t>{0, 1});
}

TEST_CASE("a copy of a chosen column is not added and a near copy is the closest alternative") {
    DFDYN_SEEDED_ENGINE(engine);
    MatrixXd columns = random_columns(5, engine);
    columns.col(3) = columns.col(0);
    columns.col(4) = columns.col(0) + 0.1 * columns.col(1);
    const VectorXd target = columns.col(0) + random_columns(1, engine);
    const SearchProblem problem = problem_of(columns, target);
    const std::vector<ChosenShape> chosen{{0, 0}};
    const std::vector<Replacement> more = Neighbours(problem, chosen).additions();
    CHECK(std::ranges::none_of(more, [](const Replacement& one) { return one.with.candidate == 3; }));
    const std::vector<Replacement> instead = Neighbours(problem, {}).additions();
    CHECK(std::abs(instead[0].score - instead[1].score) < 1e-9);
    CHECK(instead[2].with.candidate == 4);
}

TEST_CASE("a nuisance parameter has a Gaussian prior with its own standard deviation") {
    DFDYN_SEEDED_ENGINE(engine);
    const MatrixXd columns = random_columns(3, engine);
    const VectorXd target = 0.05 * columns.col(0) + 0.5 * columns.col(1) + random_columns(1, engine);
    SearchProblem problem = problem_of(columns, target);
    problem.nuisance = {{0, 0.058}};
    problem.candidates.erase(problem.candidates.begin());
    const EffectFit fit = fit_effects(problem, search_effects(problem, {}));
    REQUIRE(fit.columns.size() == 2);
    MatrixXd system = (columns.leftCols(2).transpose() * columns.leftCols(2)).eval();
    system(0, 0) += 1 / (0.058 * 0.058);
    const VectorXd exact = solve_symmetric(system, VectorXd(columns.leftCols(2).transpose() * target));
    CHECK((fit.coefficients - exact).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE(
    "an effect that a nuisance parameter can imitate is found and kept where it is too large for the prior") {
    DFDYN_SEEDED_ENGINE(engine);
    // Leaves only a thousandth of its copy unexplained.
    const MatrixXd nuisance = 30 * random_columns(1, engine);
    const VectorXd target = 0.4 * nuisance + random_columns(1, engine);
    MatrixXd columns(rows, 2);
    columns << nuisance, nuisance;
    SearchProblem problem = problem_of(columns, target);
    problem.nuisance = {{0, 0.058}};
    problem.candidates.erase(problem.candidates.begin());
    const std::vector<ChosenShape> chosen = search_effects(problem, {});
    REQUIRE(chosen.size() == 1);
    std::vector<WeightedSums> blocks;
    for (const Index first : {Index{0}, rows / 2}) {
        blocks.push_back(
            problem_of(columns.middleRows(first, rows / 2), target.segment(first, rows / 2)).sums);
    }
    CHECK(held_out_score(problem, blocks, chosen) > held_out_score(problem, blocks, {}));
}

TEST_CASE("the held-out score predicts each block by least squares of all other blocks") {
    DFDYN_SEEDED_ENGINE(engine);
    const MatrixXd columns = random_columns(5, engine);
    VectorXd target = columns.col(0) + random_columns(1, engine);
    constexpr Index blocks = 4;
    constexpr Index size = rows / blocks;
    target.segment(size, size) += 0.4 * columns.col(1).segment(size, size); // in one block only
    SearchProblem problem = problem_of(columns, target);
    std::vector<WeightedSums> sums;
    for (Index block = 0; block < blocks; ++block) {
        sums.push_back(
            problem_of(columns.middleRows(block * size, size), target.segment(block * size, size)).sums);
    }
    const auto expected = [&](const std::vector<Index>& chosen) {
        double score = 0;
        for (Index block = 0; block < blocks; ++block) {
            MatrixXd others(rows - size, static_cast<Index>(chosen.size()));
            VectorXd wanted(rows - size);
            others << columns(Eigen::seqN(0, block * size), chosen),
                columns(Eigen::seqN((block + 1) * size, rows - (block + 1) * size), chosen);
            wanted << target.head(block * size), target.tail(rows - (block + 1) * size);
            const VectorXd fit = least_squares(others, wanted);
            const VectorXd here = target.segment(block * size, size);
            const VectorXd left = here - columns(Eigen::seqN(block * size, size), chosen) * fit;
            score += 0.5 * (here.squaredNorm() - left.squaredNorm());
        }
        return score;
    };
    CHECK(held_out_score(problem, sums, {{0, 0}}) == Approx(expected({0})));
    CHECK(held_out_score(problem, sums, {{0, 0}, {1, 0}}) == Approx(expected({0, 1})));
    CHECK(held_out_score(problem, sums, {{3, 0}, {0, 0}}) == Approx(expected({3, 0})));
    CHECK(held_out_score(problem, sums, {}) == 0);
}

} // namespace effect_search_test
