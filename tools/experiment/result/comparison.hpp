// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan.hpp"
#include "tools/experiment/run/unit_result.hpp"

#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

enum class Verdict { holds, contradicted, undecided };

/// What the numbers say about a comparison. A draw's ratio is `better`'s error over `worse`'s, both with the
/// same draw and averaged over the subsets (`phase_error` of each). An infinite error is more than any other.
struct ComparisonOutcome {
    Comparison comparison;
    std::size_t draws = 0;                                     ///< that both cases have, with errors
    double lower_ratio = 0, median_ratio = 0, upper_ratio = 0; ///< quartiles; NaN without draws
    std::size_t draws_agree = 0;
    std::size_t subsets = 0, subsets_agree = 0; ///< a subset agrees by its median ratio over the draws
    double p_holds = 1;                         ///< of the signed-rank test over the draws
    double p_contradicted = 1;
    Verdict verdict = Verdict::undecided;
};

/// Draws and subsets agree when their ratio is below 1 - gain. The statement holds when the paired
/// signed-rank test over the draws' ln(ratio / (1 - gain)), 0 where both errors are infinite, says so with p
/// < 0.05 and more than half of the subsets agree; it is contradicted when the test says the opposite with p
/// < 0.05; else it is undecided. With fewer than five draws the test can decide nothing.
ComparisonOutcome compare(const Comparison& comparison, const Plan& plan, std::span<const UnitResult> units);

enum class FindingVerdict { reproduced, partly, not_reproduced, undecided };

struct FindingOutcome {
    const ExpectedFinding* finding;
    std::vector<ComparisonOutcome> comparisons;
    FindingVerdict verdict;
};

/// Reproduced: all comparisons hold. Partly: some, not all. Not reproduced: none holds, and at least one is
/// contradicted. Undecided: none holds, none is contradicted.
FindingVerdict verdict_of(std::span<const ComparisonOutcome> comparisons);

std::vector<ComparisonOutcome> compare_all(std::span<const Comparison> comparisons, const Plan& plan,
                                           std::span<const UnitResult> units);

std::vector<FindingOutcome> judge_findings(const Plan& plan, std::span<const UnitResult> units);

std::string to_string(Verdict verdict);
std::string to_string(FindingVerdict verdict);

/// "17 % less", "12 % more", "4.2 times as much": the error that this ratio means.
std::string ratio_text(double ratio);

} // namespace dfdyn::tools
