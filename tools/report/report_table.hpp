// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/report/report.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Formats the numbers of one column. The number of decimals gives a typical number three digits, and the
/// smallest one that is not zero at least one; whole numbers have none. Infinity becomes "∞", and other
/// values that are not finite become "–". In a column that spans more than five decades or needs more than
/// nine decimals, each number has three digits.
std::vector<std::string> format_column(const std::vector<double>& numbers);

/// Returns the table as HTML. Columns with numbers are right-aligned. Every row must be as long as `columns`.
std::string table_html(const ReportTable& table);

/// Returns the table as Markdown (GitHub's dialect).
std::string table_markdown(const ReportTable& table);

/// Returns names and values as an HTML description list; empty without facts.
std::string facts_html(const std::vector<ReportFact>& facts);

} // namespace dfdyn::tools
