// SPDX-License-Identifier: Apache-2.0
#include "tools/report/report_table.hpp"

#include "tools/report/page_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <string_view>

namespace dfdyn::tools {
namespace {

constexpr double widest_fixed_ratio = 1e5;
constexpr double largest_fixed = 1e15;
constexpr double most_decimals = 9;

/// Range of the magnitudes of a column's numbers that are finite and not zero.
struct Magnitudes {
    double smallest = std::numeric_limits<double>::infinity();
    double largest = 0.0;
    double mean_exponent = 0.0;
    bool whole = true;
};

Magnitudes measure(const std::vector<double>& numbers) {
    Magnitudes magnitudes;
    double exponents = 0.0;
    double count = 0.0;
    for (const double number : numbers) {
        if (!std::isfinite(number) || number == 0.0) {
            continue;
        }
        const double size = std::abs(number);
        magnitudes.smallest = std::min(magnitudes.smallest, size);
        magnitudes.largest = std::max(magnitudes.largest, size);
        magnitudes.whole = magnitudes.whole && size == std::floor(size);
        exponents += std::log10(size);
        count += 1.0;
    }
    magnitudes.mean_exponent = count > 0.0 ? exponents / count : 0.0;
    return magnitudes;
}

std::string to_text(double number, std::chars_format format, int precision) {
    if (!std::isfinite(number)) {
        return number > 0 ? "∞" : "–";
    }
    std::array<char, 64> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), number, format, precision).ptr;
    return {text.data(), end};
}

bool is_number(const ReportCell& cell) { return std::holds_alternative<double>(cell); }

struct Column {
    std::vector<std::string> cells; ///< plain text
    bool numeric = false;
};

Column format_cells(const ReportTable& table, std::size_t index) {
    std::vector<double> numbers;
    for (const auto& row : table.rows) {
        numbers.push_back(is_number(row[index]) ? std::get<double>(row[index])
                                                : std::numeric_limits<double>::quiet_NaN());
    }
    const std::vector<std::string> formatted = format_column(numbers);
    Column column;
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const ReportCell& cell = table.rows[i][index];
        column.cells.push_back(is_number(cell) ? formatted[i] : std::get<std::string>(cell));
        column.numeric = column.numeric || is_number(cell);
    }
    return column;
}

std::string cell_html(const std::string& content, std::string_view scope, std::string_view classes) {
    const std::string element = scope.empty() ? "td" : "th";
    std::string html = "<" + element;
    if (!scope.empty()) {
        html.append(" scope=\"").append(scope).append("\"");
    }
    if (!classes.empty()) {
        html.append(" class=\"").append(classes).append("\"");
    }
    return html + ">" + content + "</" + element + ">";
}

std::string_view class_of(const Column& column) { return column.numeric ? "number" : ""; }

/// Returns the cell of a column's name. The style sheet gives long names room for two lines instead of more.
std::string head_html(const std::string& name, const Column& column) {
    constexpr std::size_t short_name = 14;
    std::string classes{class_of(column)};
    if (name.size() > short_name) {
        classes += classes.empty() ? "long" : " long";
    }
    return cell_html(escape_html(name), "col", classes);
}

std::string body_row_html(const std::vector<Column>& columns, std::size_t row) {
    std::string html = "<tr>";
    for (std::size_t i = 0; i < columns.size(); ++i) {
        html += cell_html(escape_html(columns[i].cells[row]), i == 0 ? "row" : "", class_of(columns[i]));
    }
    return html + "</tr>\n";
}

/// Returns `text` with each word in a separate element, so that lines break at spaces and not inside `-O3`.
std::string words_html(const std::string& text) {
    std::istringstream stream{text};
    std::string html;
    for (std::string word; stream >> word;) {
        html += (html.empty() ? "<span>" : " <span>") + escape_html(word) + "</span>";
    }
    return html;
}

} // namespace

std::vector<std::string> format_column(const std::vector<double>& numbers) {
    const Magnitudes magnitudes = measure(numbers);
    const double of_smallest = -std::floor(std::log10(magnitudes.smallest)); // decimals that show it
    const bool fixed = magnitudes.largest <= magnitudes.smallest * widest_fixed_ratio &&
                       magnitudes.largest < largest_fixed && of_smallest <= most_decimals;
    const int decimals = static_cast<int>(
        std::clamp(std::max(2 - std::floor(magnitudes.mean_exponent), of_smallest), 0.0, most_decimals));
    std::vector<std::string> texts;
    for (const double number : numbers) {
        if (magnitudes.whole && magnitudes.largest < largest_fixed) {
            texts.push_back(to_text(number, std::chars_format::fixed, 0));
        } else if (fixed) {
            texts.push_back(to_text(number, std::chars_format::fixed, decimals));
        } else {
            texts.push_back(to_text(number, std::chars_format::general, 3));
        }
    }
    return texts;
}

std::string table_html(const ReportTable& table) {
    std::vector<Column> columns;
    std::string head;
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        columns.push_back(format_cells(table, i));
        head += head_html(table.columns[i], columns.back());
    }
    std::string body;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        body += body_row_html(columns, row);
    }
    const std::string caption = escape_html(table.caption);
    std::string html =
        "<figure class=\"table\">\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" +
        caption + "\">\n<table>\n<caption>" + caption + "</caption>\n<thead><tr>" + head +
        "</tr></thead>\n<tbody>\n" + body + "</tbody>\n</table>\n</div>\n";
    if (!table.note.empty()) {
        html += "<figcaption>" + escape_html(table.note) + "</figcaption>\n";
    }
    return html + "</figure>\n";
}

std::string table_markdown(const ReportTable& table) {
    std::ostringstream head;
    std::ostringstream rule;
    std::vector<Column> columns;
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        columns.push_back(format_cells(table, i));
        head << "| " << escape_markdown(table.columns[i]) << ' ';
        rule << (columns.back().numeric ? "| ---: " : "| --- ");
    }
    std::ostringstream text;
    text << "**" << escape_markdown(table.caption) << "**\n\n" << head.str() << "|\n" << rule.str() << "|\n";
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        for (const Column& column : columns) {
            text << "| " << escape_markdown(column.cells[row]) << ' ';
        }
        text << "|\n";
    }
    if (!table.note.empty()) {
        text << '\n' << escape_markdown(table.note) << '\n';
    }
    return text.str();
}

std::string facts_html(const std::vector<ReportFact>& facts) {
    if (facts.empty()) {
        return {};
    }
    std::string html = "<dl class=\"facts\">\n";
    for (const ReportFact& fact : facts) {
        html += "<div><dt>" + escape_html(fact.name) + "</dt><dd>" + words_html(fact.value) + "</dd></div>\n";
    }
    return html + "</dl>\n";
}

} // namespace dfdyn::tools
