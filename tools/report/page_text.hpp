// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>

namespace dfdyn::tools {

/// `text` for the content or a quoted attribute of an HTML element.
std::string escape_html(std::string_view text);

/// `text` on one line of Markdown, a table's cell included, without any markup of its own.
std::string escape_markdown(std::string_view text);

/// `data` as JSON that can stand inside a <script> element: no '<', '>' or '&'; bytes that are not UTF-8
/// become U+FFFD.
std::string script_json(const nlohmann::json& data);

/// The IEEE 754 bytes of `values`, little-endian, in base64.
std::string base64_floats(std::span<const float> values);
std::string base64_doubles(std::span<const double> values);

/// `page` with each {{name}} replaced by its text, which is not searched again; each {{ of `page` has its }}.
/// Throws std::out_of_range for a name without a text.
std::string fill_page(std::string_view page, const std::map<std::string, std::string, std::less<>>& texts);

} // namespace dfdyn::tools
