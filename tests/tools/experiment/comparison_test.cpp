// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/result/comparison.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/experiment/synthetic_jobs.hpp"

#include <cmath>
#include <limits>

namespace comparison_test {

using namespace dfdyn::tools;
using dfdyn::tests::job_at;
using dfdyn::tests::two_case_plan;

/// Units in which the errors of A are `ratio` times those of B in each draw.
std::vector<JobResult> units_with(double ratio, std::size_t draws, std::mt19937_64& engine) {
    std::vector<JobResult> jobs;
    for (std::size_t seed = 1; seed <= draws; ++seed) {
        jobs.push_back(job_at("A", seed, ratio * static_cast<double>(seed), engine));
        jobs.push_back(job_at("B", seed, static_cast<double>(seed), engine));
    }
    return jobs;
}

const double infinite = std::numeric_limits<double>::infinity();

/// Makes one tick of the first group of `name` infinite in every subset of the draws up to `last`.
void lose(std::vector<JobResult>& jobs, const std::string& name, std::size_t tick, std::uint64_t last = 100) {
    for (JobResult& job : jobs) {
        for (std::vector<double>& subset : job.error[0]) {
            subset[tick] = job.case_name == name && job.seed <= last ? infinite : subset[tick];
        }
    }
}

const Comparison a_is_less{"A", "B", "force", Phase::steady, 0};

TEST_CASE("a clear difference in every draw holds and the opposite claim is contradicted") {
    DFDYN_SEEDED_ENGINE(engine);
    const Plan plan = two_case_plan(10);
    const std::vector<JobResult> jobs = units_with(0.6, 10, engine);
    const ComparisonOutcome outcome = compare(a_is_less, plan, jobs);
    CHECK(outcome.verdict == Verdict::holds);
    CHECK(outcome.draws == 10);
    CHECK(outcome.draws_agree == 10);
    CHECK(outcome.subsets == 3);
    CHECK(outcome.subsets_agree == 3);
    CHECK(outcome.median_ratio == Approx(0.6).epsilon(0.05));
    CHECK(outcome.p_holds == Approx(1.0 / 1024));
    CHECK(compare({"B", "A", "force", Phase::steady, 0}, plan, jobs).verdict == Verdict::contradicted);
}

TEST_CASE("a comparison holds only with its claimed gain") {
    DFDYN_SEEDED_ENGINE(engine);
    const Plan plan = two_case_plan(10);
    const std::vector<JobResult> jobs = units_with(0.8, 10, engine);
    const auto with_gain = [&](const std::string& better, const std::string& worse, double gain) {
        return compare({better, worse, "torque", Phase::transient, gain}, plan, jobs).verdict;
    };
    CHECK(with_gain("A", "B", 0.1) == Verdict::holds);
    CHECK(with_gain("A", "B", 0.3) == Verdict::contradicted);
    CHECK(with_gain("B", "A", -0.1) == Verdict::contradicted);
    CHECK(with_gain("B", "A", -0.4) == Verdict::holds); // 25 % more is at most 40 % more
}

TEST_CASE("too few or contradictory or missing draws leave a comparison undecided") {
    DFDYN_SEEDED_ENGINE(engine);
    CHECK(compare(a_is_less, two_case_plan(4), units_with(0.1, 4, engine)).verdict == Verdict::undecided);
    CHECK(compare(a_is_less, two_case_plan(5), units_with(0.1, 5, engine)).verdict == Verdict::holds);
    std::vector<JobResult> mixed = units_with(0.5, 4, engine);
    for (const JobResult& job : units_with(2, 8, engine)) {
        if (job.seed > 4) {
            mixed.push_back(job);
        }
    }
    const ComparisonOutcome outcome = compare(a_is_less, two_case_plan(8), mixed);
    CHECK(outcome.verdict == Verdict::undecided);
    CHECK(outcome.draws_agree == 4);
    const ComparisonOutcome missing = compare(a_is_less, two_case_plan(8), {});
    CHECK(missing.verdict == Verdict::undecided);
    CHECK(missing.draws == 0);
    CHECK(std::isnan(missing.median_ratio));
}

TEST_CASE("a difference in only one subset does not hold") {
    DFDYN_SEEDED_ENGINE(engine);
    std::vector<JobResult> jobs = units_with(1.05, 10, engine);
    for (JobResult& job : jobs) {
        for (double& error : job.error[0][1]) {
            error *= job.case_name == "A" ? 0.1 : 1;
        }
    }
    const ComparisonOutcome outcome = compare(a_is_less, two_case_plan(10), jobs);
    CHECK(outcome.p_holds < 0.05);
    CHECK(outcome.subsets_agree == 1);
    CHECK(outcome.verdict == Verdict::undecided);
}

/// Cuts the given subset of both groups after 1 s, so that it has no steady state.
void shorten(std::vector<JobResult>& jobs, std::size_t subset) {
    for (JobResult& job : jobs) {
        for (auto& group : job.error) {
            group[subset].resize(10);
        }
    }
}

TEST_CASE("a subset without ticks of the phase is left out of the comparison") {
    DFDYN_SEEDED_ENGINE(engine);
    const Plan plan = two_case_plan(10);
    std::vector<JobResult> jobs = units_with(0.6, 10, engine);
    shorten(jobs, 0);
    shorten(jobs, 2);
    const ComparisonOutcome outcome = compare(a_is_less, plan, jobs);
    CHECK(outcome.draws == 10);
    CHECK(outcome.median_ratio == Approx(0.6).epsilon(0.1));
    CHECK(outcome.subsets == 1);
    CHECK(outcome.subsets_agree == 1);
    CHECK(outcome.verdict == Verdict::holds);
    CHECK(compare({"A", "B", "force", Phase::transient, 0}, plan, jobs).subsets == 3);
    shorten(jobs, 1);
    const ComparisonOutcome nothing = compare(a_is_less, plan, jobs);
    CHECK(nothing.draws == 0);
    CHECK(nothing.subsets == 0);
    CHECK(std::isnan(nothing.median_ratio));
    CHECK(nothing.verdict == Verdict::undecided);
}

TEST_CASE("a case that loses ticks loses the draw") {
    DFDYN_SEEDED_ENGINE(engine);
    const Plan plan = two_case_plan(10);
    const Comparison transient{"A", "B", "force", Phase::transient, 0};
    std::vector<JobResult> jobs = units_with(0.5, 10, engine);
    SECTION("the better one") {
        lose(jobs, "A", 4);
        const ComparisonOutcome outcome = compare(transient, plan, jobs);
        CHECK(outcome.draws == 10);
        CHECK(outcome.draws_agree == 0);
        CHECK(outcome.subsets_agree == 0);
        CHECK(outcome.median_ratio == infinite);
        CHECK(outcome.verdict == Verdict::contradicted);
        CHECK(compare(a_is_less, plan, jobs).verdict == Verdict::holds); // no tick of this phase was lost
    }
    SECTION("the better one in some draws") {
        lose(jobs, "A", 4, 4);
        const ComparisonOutcome outcome = compare(transient, plan, jobs);
        CHECK(outcome.draws_agree == 6);
        CHECK(outcome.subsets_agree == 3);
        CHECK(outcome.upper_ratio == infinite);
        CHECK(outcome.verdict == Verdict::undecided);
    }
    SECTION("the worse one") {
        lose(jobs, "B", 4);
        const ComparisonOutcome outcome = compare({"A", "B", "force", Phase::transient, 0.9}, plan, jobs);
        CHECK(outcome.median_ratio == 0);
        CHECK(outcome.verdict == Verdict::holds);
    }
    SECTION("both: a tie, whatever the gain") {
        lose(jobs, "A", 4);
        lose(jobs, "B", 5);
        for (const double gain : {-0.5, 0.0, 0.5}) {
            const ComparisonOutcome outcome =
                compare({"A", "B", "force", Phase::transient, gain}, plan, jobs);
            CHECK(outcome.draws == 10);
            CHECK(outcome.draws_agree == 0);
            CHECK(outcome.median_ratio == 1);
            CHECK(outcome.verdict == Verdict::undecided);
        }
    }
}

TEST_CASE("the spread of a comparison is the quartiles of its ratio over the draws") {
    DFDYN_SEEDED_ENGINE(engine);
    std::vector<JobResult> jobs;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        jobs.push_back(job_at("A", seed, 0.1 * static_cast<double>(seed), engine));
        jobs.push_back(job_at("B", seed, 1, engine));
    }
    const ComparisonOutcome outcome = compare(a_is_less, two_case_plan(5), jobs);
    CHECK(outcome.lower_ratio == Approx(0.2).epsilon(0.1));
    CHECK(outcome.median_ratio == Approx(0.3).epsilon(0.1));
    CHECK(outcome.upper_ratio == Approx(0.4).epsilon(0.1));
}

TEST_CASE("the draws are paired by their seed and not by their order") {
    DFDYN_SEEDED_ENGINE(engine);
    std::vector<JobResult> jobs = units_with(0.9, 10, engine);
    std::ranges::reverse(jobs);
    std::swap(jobs[0], jobs[7]);
    // Without pairing, the levels 1 to 10 of the draws would hide the difference.
    CHECK(compare(a_is_less, two_case_plan(10), jobs).draws_agree == 10);
}

TEST_CASE("the verdict on a finding follows from its comparisons") {
    const auto verdict = [](std::initializer_list<Verdict> verdicts) {
        std::vector<ComparisonOutcome> outcomes;
        for (const Verdict one : verdicts) {
            outcomes.emplace_back().verdict = one;
        }
        return verdict_of(outcomes);
    };
    const Verdict holds = Verdict::holds;
    const Verdict contradicted = Verdict::contradicted;
    const Verdict undecided = Verdict::undecided;
    CHECK(verdict({holds, holds}) == FindingVerdict::reproduced);
    CHECK(verdict({holds, holds, contradicted}) == FindingVerdict::partly);
    CHECK(verdict({holds, contradicted}) == FindingVerdict::not_reproduced);
    CHECK(verdict({holds, undecided}) == FindingVerdict::partly);
    CHECK(verdict({contradicted, undecided}) == FindingVerdict::not_reproduced);
    CHECK(verdict({contradicted}) == FindingVerdict::not_reproduced);
    CHECK(verdict({undecided}) == FindingVerdict::undecided);
}

TEST_CASE("ratios are formatted in words") {
    CHECK(ratio_text(0.83) == "17 % less");
    CHECK(ratio_text(1.12) == "12 % more");
    CHECK(ratio_text(4.2) == "4.2 times as much");
    CHECK(ratio_text(std::nan("")) == "not comparable");
    CHECK(ratio_text(infinite) == "∞ times as much");
}

} // namespace comparison_test
