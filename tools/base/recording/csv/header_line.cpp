// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/csv/header_line.hpp"

#include "tools/base/recording/csv/csv_line.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>

namespace dfdyn::tools {
namespace {

/// Returns ` (...)` with the probable cause of bytes that are no text; empty if none is known.
std::string cause_of_no_text(std::string_view line) {
    if (line.starts_with("\xff\xfe") || line.starts_with("\xfe\xff")) {
        return " (UTF-16: save it as UTF-8, or iconv -f UTF-16 -t UTF-8)";
    }
    if (line.find('\r') != std::string_view::npos) {
        return " (lines end with CR alone: convert them to LF, such as with tr '\\r' '\\n')";
    }
    return "";
}

void require_text(std::string_view line, const std::string& where) {
    const auto is_control = [](char character) {
        const auto byte = static_cast<unsigned char>(character);
        return (byte < 0x20 && byte != '\t') || byte == 0x7f;
    };
    if (std::any_of(line.begin(), line.end(), is_control)) {
        throw InputError(where + ": expected a header of column names, found no text: " + in_quotes(line) +
                         cause_of_no_text(line));
    }
}

/// Rejects `(1600000000.000000) can0 181#00`.
void require_no_candump(std::string_view line, const std::string& where) {
    const std::size_t end = line.find(") ");
    if (line.starts_with('(') && end != std::string_view::npos &&
        line.find('#', end) != std::string_view::npos) {
        throw InputError(where + ": expected a header of column names, found a line of a candump log, which "
                                 "needs --bus (dfdyn replay)");
    }
}

} // namespace

std::vector<std::string> header_names(std::string_view line, char separator, const std::string& where) {
    require_text(line, where);
    require_no_candump(line, where);
    std::vector<std::string_view> fields;
    split_fields(line, separator, fields);
    for (const std::string_view field : fields) {
        if (field.find('"') != std::string_view::npos) {
            throw InputError(where + ": expected a column name, found " + in_quotes(field) +
                             " (a quoted name ends with a quote and holds none)");
        }
    }
    if (fields.size() == 1 && fields.front().find(' ') != std::string_view::npos) {
        throw InputError(where + ": expected column names separated by commas, semicolons or tabs, found " +
                         in_quotes(" ") + " between them");
    }
    return {fields.begin(), fields.end()};
}

std::string from_zero(const std::vector<std::string>& columns) {
    std::string option;
    for (const std::string quantity : {"q", "qd", "qdd", "tau", "i"}) {
        std::vector<std::string> numbered;
        while (std::ranges::find(columns, quantity + std::to_string(numbered.size())) != columns.end()) {
            numbered.push_back(quantity + std::to_string(numbered.size()));
        }
        const auto alike = std::ranges::count_if(
            columns, [&](const std::string& name) { return name.starts_with(quantity); });
        std::string pattern = quantity + "*";
        if (alike != std::ssize(numbered)) {
            pattern.clear();
            for (const std::string& name : numbered) {
                pattern += (pattern.empty() ? "" : "|") + name;
            }
        }
        if (!numbered.empty()) {
            option += (option.empty() ? "" : ",") + quantity + "=" + pattern;
        }
    }
    const bool quotes = option.find('|') != std::string::npos; // for the shell
    return " (--columns " + (quotes ? "'" + option + "'" : option) + ")";
}

} // namespace dfdyn::tools
