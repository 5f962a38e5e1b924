// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan_data.hpp"
#include "tools/experiment/run/run_plan.hpp"

#include <filesystem>
#include <string>

namespace dfdyn::tools {

/// Writes the results of an evaluation into `folder`: results.csv, tables.md, report.html, findings.md,
/// verdicts.md, and pictures/PLAN_FIGURE_GROUP_{curves,boxes}.svg. They appear together or not at all.
void write_evaluation(const std::filesystem::path& folder, const Plan& plan, const PlanData& data,
                      const EvaluationResults& results);

} // namespace dfdyn::tools
