// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>

namespace dfdyn::tools {

/// Escapes `text` for the content or a quoted attribute of an HTML element.
std::string escape_html(std::string_view text);

/// Escapes `text` for one line of Markdown, including table cells, without any markup.
std::string escape_markdown(std::string_view text);

/// Returns `data` as JSON for a <script> element: without '<', '>' and '&'; bytes that are not UTF-8 become
/// U+FFFD.
std::string script_json(const nlohmann::json& data);

/// Returns the IEEE 754 bytes of `values`, little-endian, in base64.
std::string base64_floats(std::span<const float> values);
std::string base64_doubles(std::span<const double> values);

/// Returns `page` with each {{name}} replaced by its text. Replaced texts are not searched again. Each {{ in
/// `page` must have its }}. Throws std::out_of_range for a name without a text.
std::string fill_page(std::string_view page, const std::map<std::string, std::string, std::less<>>& texts);

/// The parts of a page: plain text for `title` and `summary`, HTML for the others.
struct PageParts {
    std::string title, summary;
    std::string remark;        ///< below the summary; may be empty
    std::string style;         ///< style sheets
    std::string content;       ///< below the header
    std::string notice;        ///< comment in the head; may be empty
    std::string scripts;       ///< after the content; may be empty
    std::string script_policy; ///< addition to the page's security policy; empty without scripts
};

/// Returns the page as one HTML file. All pages of the program have this frame.
std::string page_html(const PageParts& parts);

} // namespace dfdyn::tools
