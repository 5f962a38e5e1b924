// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/report/report.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// A chart, as `curve_chart` or `box_chart` gives it.
struct PageChart {
    std::string name;  ///< of its file, without ending: letters, digits, '-' and '_'
    std::string title; ///< read out where the picture is not seen
    std::string svg;
};

/// A part of a page: a heading, paragraphs, charts side by side, tables.
struct PageSection {
    std::string heading;
    std::vector<std::string> paragraphs;
    std::vector<PageChart> charts;
    std::vector<ReportTable> tables;
};

/// A page without ticks: charts that do not change, tables and facts. Every string but the charts is plain
/// UTF-8 text; what renders the page escapes it.
struct FigurePage {
    std::string title, summary;
    std::vector<PageSection> sections;
    std::vector<ReportFact> facts;
};

/// The page as one HTML file that needs no other file, no network and no script.
std::string render_figure_page(const FigurePage& page);

/// The same page as a chapter in Markdown, its title a heading of level two. The charts are files NAME.svg in
/// the folder `pictures` beside it.
std::string figure_page_markdown(const FigurePage& page);

} // namespace dfdyn::tools
