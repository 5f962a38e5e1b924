// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/result/comparison.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/experiment/result/phase_error.hpp"
#include "tools/experiment/result/wilcoxon.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double significance = 0.05;

/// Results of both cases for the same draw.
struct Pair {
    const JobResult* better;
    const JobResult* worse;
};

std::vector<Pair> pairs_of(const Comparison& comparison, std::span<const JobResult> jobs) {
    std::vector<Pair> pairs;
    for (const JobResult& better : jobs) {
        const auto worse = std::ranges::find_if(jobs, [&](const JobResult& job) {
            return job.case_name == comparison.worse && job.seed == better.seed;
        });
        if (better.case_name == comparison.better && worse != jobs.end()) {
            pairs.push_back({&better, &*worse});
        }
    }
    return pairs;
}

struct ErrorPair {
    double better = 0, worse = 0;

    bool there() const { return !std::isnan(better) && !std::isnan(worse); }

    /// 1 also if both are 0 or both infinite.
    double ratio() const { return better == worse ? 1 : better / worse; }

    /// Returns ln(ratio / threshold), limited to finite values if one error is 0 or infinite; 0 (a tie) if
    /// both are infinite.
    double difference(double threshold) const {
        constexpr double most = 1e300;
        const bool tie = std::isinf(better) && std::isinf(worse);
        return tie ? 0 : std::clamp(std::log(ratio() / threshold), -most, most);
    }
};

/// The errors of both cases in each subset, over the plan's groups and phases.
class PairErrors {
  public:
    PairErrors(const Comparison& comparison, const Plan& plan)
        : phase_(comparison.phase), steady_after_s_(plan.steady_after_s),
          group_(static_cast<std::size_t>(
              std::ranges::find(plan.groups, comparison.group, &OutputGroup::name) - plan.groups.begin())) {}

    ErrorPair in_subset(const Pair& pair, std::size_t subset) const {
        return {error(*pair.better, subset), error(*pair.worse, subset)};
    }

    /// Returns the sum over the subsets that have errors in the phase; NaN if none has.
    ErrorPair of(const Pair& pair) const {
        constexpr double none = std::numeric_limits<double>::quiet_NaN();
        ErrorPair sum;
        bool any = false;
        for (std::size_t subset = 0; subset < subset_count(pair); ++subset) {
            const ErrorPair errors = in_subset(pair, subset);
            if (errors.there()) {
                sum.better += errors.better;
                sum.worse += errors.worse;
                any = true;
            }
        }
        return any ? sum : ErrorPair{none, none};
    }

    std::size_t subset_count(const Pair& pair) const { return pair.better->error[group_].size(); }

  private:
    double error(const JobResult& job, std::size_t subset) const {
        return phase_error(job, group_, subset, phase_, steady_after_s_);
    }

    Phase phase_;
    double steady_after_s_;
    std::size_t group_;
};

Verdict verdict_of(const ComparisonOutcome& outcome) {
    if (outcome.p_holds < significance && 2 * outcome.subsets_agree > outcome.subsets) {
        return Verdict::holds;
    }
    return outcome.p_contradicted < significance ? Verdict::contradicted : Verdict::undecided;
}

/// Returns the differences of all draws in one subset.
std::vector<double> differences_in(const std::vector<Pair>& pairs, const PairErrors& errors,
                                   std::size_t subset, double threshold) {
    std::vector<double> differences;
    for (const Pair& pair : pairs) {
        const ErrorPair both = errors.in_subset(pair, subset);
        if (both.there()) {
            differences.push_back(both.difference(threshold));
        }
    }
    return differences;
}

} // namespace

ComparisonOutcome compare(const Comparison& comparison, const Plan& plan, std::span<const JobResult> jobs) {
    ComparisonOutcome outcome{comparison};
    const double threshold = 1 - comparison.gain;
    const PairErrors errors(comparison, plan);
    const std::vector<Pair> pairs = pairs_of(comparison, jobs);
    std::vector<double> ratios;
    std::vector<double> differences;
    for (const Pair& pair : pairs) {
        const ErrorPair both = errors.of(pair);
        if (both.there()) {
            ratios.push_back(both.ratio());
            differences.push_back(both.difference(threshold));
            outcome.draws_agree += differences.back() < 0 ? 1 : 0;
        }
    }
    outcome.draws = ratios.size();
    const Box box = box_of(std::move(ratios));
    outcome.lower_ratio = box.lower_quartile;
    outcome.median_ratio = box.median;
    outcome.upper_ratio = box.upper_quartile;
    const std::size_t subsets = pairs.empty() ? 0 : errors.subset_count(pairs.front());
    for (std::size_t subset = 0; subset < subsets; ++subset) {
        std::vector<double> in_subset = differences_in(pairs, errors, subset, threshold);
        outcome.subsets += in_subset.empty() ? 0 : 1;
        outcome.subsets_agree += median(std::move(in_subset)) < 0 ? 1 : 0;
    }
    const SignedRankTest test = signed_rank_test(differences);
    outcome.p_holds = test.p_negative;
    outcome.p_contradicted = test.p_positive;
    outcome.verdict = verdict_of(outcome);
    return outcome;
}

FindingVerdict verdict_of(std::span<const ComparisonOutcome> comparisons) {
    const auto count = [&](Verdict verdict) {
        return std::ranges::count(comparisons, verdict, &ComparisonOutcome::verdict);
    };
    if (count(Verdict::holds) == std::ssize(comparisons)) {
        return FindingVerdict::reproduced;
    }
    if (count(Verdict::holds) > count(Verdict::contradicted)) {
        return FindingVerdict::partly;
    }
    return count(Verdict::contradicted) > 0 ? FindingVerdict::not_reproduced : FindingVerdict::undecided;
}

std::vector<ComparisonOutcome> compare_all(std::span<const Comparison> comparisons, const Plan& plan,
                                           std::span<const JobResult> jobs) {
    std::vector<ComparisonOutcome> outcomes;
    for (const Comparison& comparison : comparisons) {
        outcomes.push_back(compare(comparison, plan, jobs));
    }
    return outcomes;
}

std::vector<FindingOutcome> judge_findings(const Plan& plan, std::span<const JobResult> jobs) {
    std::vector<FindingOutcome> outcomes;
    for (const ExpectedFinding& finding : plan.findings) {
        std::vector<ComparisonOutcome> comparisons = compare_all(finding.comparisons, plan, jobs);
        const FindingVerdict verdict = verdict_of(comparisons);
        outcomes.push_back({&finding, std::move(comparisons), verdict});
    }
    return outcomes;
}

std::string to_string(Verdict verdict) {
    switch (verdict) {
    case Verdict::holds:
        return "holds";
    case Verdict::contradicted:
        return "contradicted";
    case Verdict::undecided:
        break;
    }
    return "undecided";
}

std::string to_string(FindingVerdict verdict) {
    switch (verdict) {
    case FindingVerdict::reproduced:
        return "reproduced";
    case FindingVerdict::partly:
        return "partly reproduced";
    case FindingVerdict::not_reproduced:
        return "not reproduced";
    case FindingVerdict::undecided:
        break;
    }
    return "undecided";
}

std::string ratio_text(double ratio) {
    std::array<char, 48> text{};
    if (std::isnan(ratio)) {
        return "not comparable";
    }
    if (std::isinf(ratio)) {
        return "∞ times as much";
    }
    if (ratio > 2) {
        std::snprintf(text.data(), text.size(), "%.1f times as much", ratio);
    } else {
        std::snprintf(text.data(), text.size(), "%.0f %% %s", 100 * std::abs(1 - ratio),
                      ratio <= 1 ? "less" : "more");
    }
    return text.data();
}

} // namespace dfdyn::tools
