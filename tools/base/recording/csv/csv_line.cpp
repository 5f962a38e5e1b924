// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/csv/csv_line.hpp"

#include "tools/base/text/text.hpp"

#include <algorithm>
#include <array>

namespace dfdyn::tools {
namespace {

/// Returns the end of the field that begins at `begin`: a separator, or the end of the line.
std::size_t field_end(std::string_view line, std::size_t begin, char separator) {
    const std::size_t first = line.find_first_not_of(' ', begin);
    if (first != std::string_view::npos && line[first] == '"') {
        const std::size_t close = line.find('"', first + 1);
        const std::size_t next =
            close == std::string_view::npos ? close : line.find_first_not_of(' ', close + 1);
        if (close != std::string_view::npos && (next == std::string_view::npos || line[next] == separator)) {
            return std::min(next, line.size());
        }
    }
    return std::min(line.find(separator, begin), line.size());
}

std::string_view without_quotes(std::string_view field) {
    const bool quoted = field.size() >= 2 && field.front() == '"' && field.find('"', 1) == field.size() - 1;
    return quoted ? trimmed(field.substr(1, field.size() - 2)) : field;
}

} // namespace

char separator_of(std::string_view header) {
    constexpr std::array separators{',', ';', '\t'};
    std::array<std::size_t, separators.size()> counts{};
    bool quoted = false;
    for (const char character : header) {
        quoted = quoted != (character == '"');
        const auto found = std::ranges::find(separators, character);
        if (!quoted && found != separators.end()) {
            ++counts[static_cast<std::size_t>(found - separators.begin())];
        }
    }
    return separators[static_cast<std::size_t>(std::ranges::max_element(counts) - counts.begin())];
}

void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields) {
    fields.clear();
    std::size_t begin = 0;
    while (begin <= line.size()) {
        const std::size_t end = field_end(line, begin, separator);
        fields.push_back(without_quotes(trimmed(line.substr(begin, end - begin))));
        begin = end + 1;
    }
}

ParsedNumber parse_field(std::string_view field, char separator, std::string& buffer) {
    const std::size_t comma = field.find(',');
    if (separator == ',' || comma == std::string_view::npos) {
        return parse_number(field);
    }
    buffer = field;
    buffer[comma] = '.';
    return parse_number(buffer);
}

bool is_comment(std::string_view line) { return trimmed(line).starts_with('#'); }

} // namespace dfdyn::tools
