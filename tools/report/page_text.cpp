// SPDX-License-Identifier: Apache-2.0
#include "tools/report/page_text.hpp"

#include "tools/base/text/json_text.hpp"
#include "tools/report/report_assets.hpp"

#include <nlohmann/json.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>

namespace dfdyn::tools {
namespace {

constexpr std::string_view base64_alphabet =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

void append_quantum(std::string& text, std::string_view bytes) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        bits = (bits << 8U) | (i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0U);
    }
    for (std::size_t i = 0; i < 4; ++i) {
        text += i <= bytes.size() ? base64_alphabet[(bits >> (18U - 6U * i)) & 63U] : '=';
    }
}

std::string base64(std::string_view bytes) {
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        append_quantum(text, bytes.substr(i, 3));
    }
    return text;
}

template <typename Unsigned, typename Value>
std::string base64_values(std::span<const Value> values) {
    static_assert(sizeof(Unsigned) == sizeof(Value));
    std::string bytes;
    bytes.reserve(values.size_bytes());
    for (const Value value : values) {
        const auto bits = std::bit_cast<Unsigned>(value);
        for (std::size_t i = 0; i < sizeof bits; ++i) {
            bytes += static_cast<char>(static_cast<unsigned char>(bits >> (8U * i)));
        }
    }
    return base64(bytes);
}

void replace_all(std::string& text, char wanted, std::string_view replacement) {
    for (std::size_t at = text.find(wanted); at != std::string::npos;
         at = text.find(wanted, at + replacement.size())) {
        text.replace(at, 1, replacement);
    }
}

} // namespace

std::string escape_html(std::string_view text) {
    std::string escaped{text};
    replace_all(escaped, '&', "&amp;");
    replace_all(escaped, '<', "&lt;");
    replace_all(escaped, '>', "&gt;");
    replace_all(escaped, '"', "&quot;");
    replace_all(escaped, '\'', "&#39;");
    return escaped;
}

std::string escape_markdown(std::string_view text) {
    std::string escaped;
    for (const char character : text) {
        if (std::string_view("\\`*_[]<>|").find(character) != std::string_view::npos) {
            escaped += '\\';
        }
        escaped += character == '\n' ? ' ' : character;
    }
    return escaped;
}

std::string script_json(const nlohmann::json& data) {
    std::string text = json_text(data, -1);
    replace_all(text, '&', "\\u0026");
    replace_all(text, '<', "\\u003c");
    replace_all(text, '>', "\\u003e");
    return text;
}

std::string base64_floats(std::span<const float> values) { return base64_values<std::uint32_t>(values); }

std::string base64_doubles(std::span<const double> values) { return base64_values<std::uint64_t>(values); }

std::string fill_page(std::string_view page, const std::map<std::string, std::string, std::less<>>& texts) {
    std::string filled;
    while (true) {
        const std::size_t open = page.find("{{");
        filled += page.substr(0, open);
        if (open == std::string_view::npos) {
            return filled;
        }
        const std::size_t close = page.find("}}", open);
        filled += texts.at(std::string{page.substr(open + 2, close - open - 2)});
        page.remove_prefix(close + 2);
    }
}

std::string page_html(const PageParts& parts) {
    return fill_page(assets::page_html, {{"title", escape_html(parts.title)},
                                         {"summary", escape_html(parts.summary)},
                                         {"remark", parts.remark},
                                         {"style", parts.style},
                                         {"content", parts.content},
                                         {"notice", parts.notice},
                                         {"scripts", parts.scripts},
                                         {"script_policy", parts.script_policy}});
}

} // namespace dfdyn::tools
