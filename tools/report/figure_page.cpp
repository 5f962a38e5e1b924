// SPDX-License-Identifier: Apache-2.0
#include "tools/report/figure_page.hpp"

#include "tools/report/page_text.hpp"
#include "tools/report/report_assets.hpp"
#include "tools/report/report_table.hpp"

#include <sstream>

namespace dfdyn::tools {

namespace {

std::string charts_html(const std::vector<PageChart>& charts) {
    std::string html = "<div class=\"charts\">\n";
    for (const PageChart& chart : charts) {
        html += "<div><div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" +
                escape_html(chart.title) + "\">\n" + chart.svg + "</div></div>\n";
    }
    return html + "</div>\n";
}

std::string section_html(const PageSection& section) {
    std::string html = "<section>\n<h2>" + escape_html(section.heading) + "</h2>\n";
    for (const std::string& paragraph : section.paragraphs) {
        html += "<p>" + escape_html(paragraph) + "</p>\n";
    }
    html += section.charts.empty() ? "" : charts_html(section.charts);
    for (const ReportTable& table : section.tables) {
        html += table_html(table);
    }
    return html + "</section>\n";
}

void append_paragraph(std::ostringstream& text, const std::string& paragraph) {
    text << '\n' << escape_markdown(paragraph) << '\n';
}

void append_section(std::ostringstream& text, const PageSection& section) {
    text << "\n### " << escape_markdown(section.heading) << '\n';
    for (const std::string& paragraph : section.paragraphs) {
        append_paragraph(text, paragraph);
    }
    text << (section.charts.empty() ? "" : "\n");
    for (const PageChart& chart : section.charts) {
        text << "![" << escape_markdown(chart.title) << "](pictures/" << chart.name << ".svg)\n";
    }
    for (const ReportTable& table : section.tables) {
        text << '\n' << table_markdown(table);
    }
}

} // namespace

std::string render_figure_page(const FigurePage& page) {
    PageParts parts;
    parts.title = page.title;
    parts.summary = page.summary;
    parts.style = std::string{assets::report_css}.append(assets::chart_css).append(assets::figure_page_css);
    for (const PageSection& section : page.sections) {
        parts.content += section_html(section);
    }
    parts.content += "\n" + facts_html(page.facts);
    parts.scripts = "<script>\n" + std::string{assets::figure_page_js} + "</script>\n";
    parts.script_policy = "; script-src 'unsafe-inline'; img-src data:";
    return page_html(parts);
}

std::string figure_page_markdown(const FigurePage& page) {
    std::ostringstream text;
    text << "## " << escape_markdown(page.title) << '\n';
    append_paragraph(text, page.summary);
    for (const PageSection& section : page.sections) {
        append_section(text, section);
    }
    for (const ReportFact& fact : page.facts) {
        append_paragraph(text, fact.name + ": " + fact.value);
    }
    return text.str();
}

} // namespace dfdyn::tools
