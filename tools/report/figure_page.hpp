// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/report/report.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// A chart from `curve_chart` or `box_chart`.
struct PageChart {
    std::string name;  ///< name of its file, without extension: letters, digits, '-' and '_'
    std::string title; ///< alternative text for readers who do not see the picture
    std::string svg;
};

/// A section of a page: a heading, paragraphs, charts side by side, tables.
struct PageSection {
    std::string heading;
    std::vector<std::string> paragraphs;
    std::vector<PageChart> charts;
    std::vector<ReportTable> tables;
};

/// A page with static charts, tables and facts. Every string except the charts is plain UTF-8 text and is
/// escaped when the page is rendered.
struct FigurePage {
    std::string title, summary;
    std::vector<PageSection> sections;
    std::vector<ReportFact> facts;
};

/// Returns the page as one HTML file without external files or network access. Curves can be enlarged, and
/// every chart saved as a picture.
std::string render_figure_page(const FigurePage& page);

/// Returns the page as a chapter in Markdown, with its title as a heading of level two. The charts are files
/// NAME.svg in the folder `pictures` next to it.
std::string figure_page_markdown(const FigurePage& page);

} // namespace dfdyn::tools
