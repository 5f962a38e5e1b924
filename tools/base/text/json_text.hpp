// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace dfdyn::tools {

/// Returns the text of a `nlohmann::json` or `ordered_json` with this indentation (-1: one line). Bytes that
/// are not UTF-8, which names of files may have, become U+FFFD.
template <class Json>
std::string json_text(const Json& json, int indent = 2) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

} // namespace dfdyn::tools
