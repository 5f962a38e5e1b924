// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// The files of assets/, compiled into the program by embed_assets.cmake.
namespace dfdyn::tools::assets {

extern const std::string_view page_html;
extern const std::string_view report_content_html;
extern const std::string_view report_scripts_html;
extern const std::string_view report_css;
extern const std::string_view report_charts_css;
extern const std::string_view report_data_js;
extern const std::string_view report_range_js;
extern const std::string_view report_marks_js;
extern const std::string_view report_charts_js;
extern const std::string_view report_js;
extern const std::string_view chart_css;
extern const std::string_view figure_page_css;
extern const std::string_view figure_page_js;
extern const std::string_view uplot_css;
extern const std::string_view uplot_js;
extern const std::string_view uplot_licence;

} // namespace dfdyn::tools::assets
