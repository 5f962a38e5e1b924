// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tests {

/// Describes the first error in the nesting of the elements of `markup` (HTML or SVG as this program writes
/// it), without the text of scripts. Returns an empty text if there is none.
inline std::string markup_fault(std::string_view markup) {
    constexpr std::array<std::string_view, 3> without_end{"meta", "br", "!DOCTYPE"};
    std::vector<std::string> open;
    for (std::size_t at = markup.find('<'); at != std::string_view::npos; at = markup.find('<', at + 1)) {
        const std::size_t end = markup.find('>', at);
        if (end == std::string_view::npos) {
            return "a tag without an end";
        }
        const std::string_view tag = markup.substr(at + 1, end - at - 1);
        const std::string name(tag.substr(0, tag.find_first_of(" \n/", 1)));
        if (tag.front() == '/') {
            if (open.empty() || "/" + open.back() != std::string(tag)) {
                return "<" + std::string(tag) + "> after <" + (open.empty() ? "" : open.back()) + ">";
            }
            open.pop_back();
        } else if (tag.back() != '/' && std::ranges::find(without_end, name) == without_end.end()) {
            open.push_back(name);
        }
        if (std::ranges::count(tag, '"') % 2 != 0) {
            return "an open quote in <" + std::string(tag) + ">";
        }
        if (name == "script") {
            at = markup.find("</script>", end) - 1;
        }
    }
    return open.empty() ? "" : "<" + open.back() + "> without an end";
}

} // namespace dfdyn::tests
