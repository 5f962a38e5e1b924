// SPDX-License-Identifier: Apache-2.0
#include "tools/model/header/header_text.hpp"

#include <array>
#include <charconv>

namespace dfdyn::tools {

std::string literal(float value) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    std::string result(text.data(), end);
    if (result.find_first_of(".e") == std::string::npos) {
        result += ".0";
    }
    return result + "F";
}

std::string array(std::span<const float> values) {
    constexpr std::size_t width = 100;
    std::string result = "{";
    std::size_t line = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::string item = literal(values[i]) + (i + 1 < values.size() ? "," : "");
        if (line + item.size() > width) {
            result += "\n    ";
            line = 0;
        } else if (line > 0) {
            result += ' ';
        }
        result += item;
        line += item.size() + 1;
    }
    return result + "}";
}

std::string literal(const Storage<std::int32_t, dynamic>& values) {
    std::vector<std::string> texts;
    for (const std::int32_t value : values) {
        texts.push_back(std::to_string(value));
    }
    return "{{" + joined(texts, ", ") + "}}";
}

std::string joined(std::span<const std::string> texts, const char* separator) {
    std::string result;
    for (const std::string& text : texts) {
        result += (result.empty() ? "" : separator) + text;
    }
    return result;
}

std::string type(const std::string& name, const std::vector<std::string>& arguments) {
    return "dfdyn::" + name + "<" + joined(arguments, ", ") + ">";
}

} // namespace dfdyn::tools
