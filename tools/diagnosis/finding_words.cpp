// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/finding_words.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace dfdyn::tools {

namespace {

std::string words(std::string effect, const std::string& where) {
    std::ranges::replace(effect, '_', ' ');
    return effect.append(" at ").append(where);
}

bool is_axis(const FoundParameter& parameter) {
    return parameter.name == "axis" || parameter.name == "from_axis" || parameter.name == "to_axis";
}

} // namespace

std::string rounded_text(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3g", value);
    return text.data();
}

std::string confidence_text(double confidence) {
    if (confidence > 0.99) {
        return "> 0.99";
    }
    std::array<char, 16> text{};
    std::snprintf(text.data(), text.size(), "%.2f", confidence);
    return text.data();
}

std::string parameter_words(const FoundParameter& parameter) {
    std::string text = parameter.name;
    if (is_axis(parameter)) {
        const std::vector<std::string> axes = output_names(OutputKind::wrench, 0);
        return text.append(" ").append(axes.at(static_cast<std::size_t>(parameter.value)));
    }
    text.append(" ").append(rounded_text(parameter.value));
    if (parameter.unit != "1") {
        text.append(" ").append(parameter.unit);
    }
    if (parameter.low == parameter.high) {
        return text; // a shape that is picked, not measured
    }
    return text.append(" (")
        .append(rounded_text(parameter.low))
        .append(" … ")
        .append(rounded_text(parameter.high))
        .append(")");
}

std::string main_parameter_words(const Finding& finding) {
    const auto measured = std::ranges::find_if(
        finding.parameters, [](const FoundParameter& parameter) { return parameter.low < parameter.high; });
    return measured == finding.parameters.end() ? "" : parameter_words(*measured);
}

std::string cause_words(const Finding& finding) {
    std::string text = words(finding.effect, finding.where);
    return finding.detail.empty() ? text : text.append(", ").append(finding.detail);
}

std::string cause_words(const OtherCause& cause) { return words(cause.effect, cause.where); }

std::string output_unit(const std::string& output_name) {
    return output_name.front() == 'f' ? "N" : output_name.front() == 'i' ? "A" : "N·m";
}

} // namespace dfdyn::tools
