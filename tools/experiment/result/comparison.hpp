// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan.hpp"
#include "tools/experiment/run/job_result.hpp"

#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

enum class Verdict { holds, contradicted, undecided };

/// Result of a comparison. A draw's ratio is the error of `better` divided by the error of `worse`, for the
/// same draw, averaged over the subsets that have errors in the phase (`phase_error` of each). An infinite
/// error is larger than any other.
struct ComparisonOutcome {
    Comparison comparison;
    std::size_t draws = 0;                                     ///< draws for which both cases have errors
    double lower_ratio = 0, median_ratio = 0, upper_ratio = 0; ///< quartiles; NaN without draws
    std::size_t draws_agree = 0;
    /// subsets with errors in the phase; a subset agrees by its median ratio over the draws
    std::size_t subsets = 0, subsets_agree = 0;
    double p_holds = 1; ///< p-value of the signed-rank test over the draws
    double p_contradicted = 1;
    Verdict verdict = Verdict::undecided;
};

/// Compares two cases. Draws and subsets agree if their ratio is below 1 - gain. The test is the paired
/// signed-rank test over the draws' ln(ratio / (1 - gain)), or 0 if both errors are infinite.
///
/// - The statement holds if the test confirms it with p < 0.05 and more than half of the subsets agree.
/// - It is contradicted if the test confirms the opposite with p < 0.05.
/// - Otherwise it is undecided. This is always so for fewer than five draws.
ComparisonOutcome compare(const Comparison& comparison, const Plan& plan, std::span<const JobResult> jobs);

enum class FindingVerdict { reproduced, partly, not_reproduced, undecided };

struct FindingOutcome {
    const ExpectedFinding* finding;
    std::vector<ComparisonOutcome> comparisons;
    FindingVerdict verdict;
};

/// Reproduced: all comparisons hold. Partly: more hold than are contradicted. Undecided: none holds and none
/// is contradicted. Not reproduced: otherwise.
FindingVerdict verdict_of(std::span<const ComparisonOutcome> comparisons);

std::vector<ComparisonOutcome> compare_all(std::span<const Comparison> comparisons, const Plan& plan,
                                           std::span<const JobResult> jobs);

std::vector<FindingOutcome> judge_findings(const Plan& plan, std::span<const JobResult> jobs);

std::string to_string(Verdict verdict);
std::string to_string(FindingVerdict verdict);

/// Returns the change of the error as text: "17 % less", "12 % more", "4.2 times as much".
std::string ratio_text(double ratio);

} // namespace dfdyn::tools
