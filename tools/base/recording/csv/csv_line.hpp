// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/number.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Returns the separator of a CSV header: the most frequent of comma, semicolon and tab outside quotes; a
/// comma if there is none.
char separator_of(std::string_view header);

/// Splits a line at the separators outside double quotes. A field is trimmed; a field that is quoted as a
/// whole loses its quotes. A quote that is not closed, or is followed by other text, stays in its field.
/// `fields` is overwritten, and refers to `line`. O(line).
void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields);

/// Reads a field as `parse_number` does, with a decimal comma for the point where commas do not separate
/// fields. `buffer` is overwritten.
ParsedNumber parse_field(std::string_view field, char separator, std::string& buffer);

/// Returns whether the line is a comment: `#` is its first character other than spaces and tabs.
bool is_comment(std::string_view line);

} // namespace dfdyn::tools
