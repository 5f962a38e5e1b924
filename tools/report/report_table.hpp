// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/report/report.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// The numbers of one column with as many decimals as give a typical one of them three digits; whole numbers
/// with none; "∞" for infinity, "–" for what else is not finite. A column that spans more than five decades
/// gets three digits in each number instead.
std::vector<std::string> format_column(const std::vector<double>& numbers);

/// The table as HTML. A column that holds a number is right-aligned. Every row is as long as `columns`.
std::string table_html(const ReportTable& table);

/// The same table as Markdown (GitHub's dialect).
std::string table_markdown(const ReportTable& table);

/// Names and values as an HTML description list; empty for no facts.
std::string facts_html(const std::vector<ReportFact>& facts);

} // namespace dfdyn::tools
