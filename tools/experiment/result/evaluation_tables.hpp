// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan.hpp"
#include "tools/experiment/result/comparison.hpp"
#include "tools/experiment/run/run_plan.hpp"
#include "tools/report/report.hpp"

#include <ostream>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Returns the draws of one case, in the plan's order.
std::vector<const JobResult*> draws_of(std::span<const JobResult> jobs, const std::string& case_name);

/// Returns the distribution of one group's ε over all draws, subsets and times: one row per case.
ReportTable error_table(const Plan& plan, std::span<const JobResult> jobs, std::size_t group);

/// Returns the one-step nRMSE of each output: one row per case (medians over the draws), then one per
/// alternative method.
ReportTable step_error_table(const Plan& plan, std::span<const JobResult> jobs,
                             const PlanOpponents& opponents, const std::vector<std::string>& outputs);

/// Returns the cost of each case, one row per case.
ReportTable cost_table(const Plan& plan, std::span<const JobResult> jobs);

ReportTable comparison_table(const std::string& caption, std::span<const ComparisonOutcome> outcomes);

/// Returns name, number of comparisons that hold, are contradicted and are undecided, and verdict; one row
/// per finding.
ReportTable finding_table(std::span<const FindingOutcome> findings);

/// Writes one row per case, draw and group, then one per alternative method: see docs/guide/evaluation.md for
/// the columns.
void write_results_csv(std::ostream& out, const Plan& plan, std::span<const JobResult> jobs,
                       const PlanOpponents& opponents, const std::vector<std::string>& outputs);

} // namespace dfdyn::tools
