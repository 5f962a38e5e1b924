// SPDX-License-Identifier: Apache-2.0
#include "tools/model/header/header_text.hpp"

#include "tools/model/inputs/input_description.hpp"
#include "tools/model/run_time/host_model.hpp"

#include <array>
#include <charconv>

namespace dfdyn::tools {

/// Returns a float literal that compiles to exactly `value` in single precision.
std::string literal(double value) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), static_cast<float>(value)).ptr;
    std::string result(text.data(), end);
    if (result.find_first_of(".e") == std::string::npos) {
        result += ".0";
    }
    return result + "F";
}

/// Returns `{{1.0F, 2.0F}}`, with line breaks.
std::string braced(std::span<const double> values) {
    constexpr std::size_t width = 100;
    std::string result = "{{";
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
    return result + "}}";
}

std::string joined(std::span<const std::string> texts, const char* separator) {
    std::string result;
    for (const std::string& text : texts) {
        result += (result.empty() ? "" : separator) + text;
    }
    return result;
}

std::string integers(std::span<const int> values) {
    std::vector<std::string> texts;
    for (const int value : values) {
        texts.push_back(std::to_string(value));
    }
    return "{{" + joined(texts, ", ") + "}}";
}

/// Returns `Name<a, b>` in the library's namespace.
std::string type(const std::string& name, const std::vector<std::string>& arguments) {
    return "dfdyn::" + name + "<" + joined(arguments, ", ") + ">";
}

std::string input_type(const InputModel& input) {
    return "dfdyn::" + input_description(input.kind).firmware_type(input);
}

std::string input_constants(const InputModel& input) {
    const InputForm form = input_description(input.kind).form;
    std::string fields;
    if (form == InputForm::derivatives && input.derivatives == Derivatives::estimated) {
        fields += ".position_noise_bound = " + literal(input.position_noise_bound) + ",\n        ";
    }
    if (form == InputForm::rows) {
        fields += ".rows = " + braced(firmware_rows(input)) + ",\n        ";
    }
    return "{" + fields + ".scale = " + braced(firmware_scale(input)) + "}";
}

} // namespace dfdyn::tools
