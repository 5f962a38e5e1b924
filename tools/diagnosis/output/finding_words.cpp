// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/finding_words.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

std::string words(std::string effect, const std::string& where) {
    std::ranges::replace(effect, '_', ' ');
    return effect.append(" at ").append(where);
}

/// Returns whether both names are components of one quantity: `com_x`, `com_z`; `coulomb_pos`, `coulomb_neg`.
bool are_parts_of_one(const std::string& one, const std::string& other) {
    const std::size_t stem = one.rfind('_');
    return stem != std::string::npos && stem == other.rfind('_') && one.compare(0, stem, other, 0, stem) == 0;
}

} // namespace

std::string confidence_text(double confidence) {
    return confidence > 0.99 ? "> 0.99" : formatted("%.2f", confidence);
}

std::optional<std::string> axis_of(const FoundParameter& parameter) {
    if (parameter.name != "axis" && parameter.name != "from_axis" && parameter.name != "to_axis") {
        return std::nullopt;
    }
    return output_names(OutputKind::wrench, 0).at(static_cast<std::size_t>(parameter.value));
}

std::string parameter_words(const FoundParameter& parameter) {
    std::string text = parameter.name;
    if (const std::optional<std::string> axis = axis_of(parameter)) {
        return text.append(" ").append(*axis);
    }
    text.append(" ").append(rounded_text(parameter.value));
    if (parameter.unit != "1") {
        text.append(" ").append(parameter.unit);
    }
    if (parameter.low == parameter.high) {
        return text; // selected from a list, not estimated
    }
    return text.append(" (").append(interval_words(parameter)).append(")");
}

std::string main_parameter_words(const Finding& finding) {
    const auto measured = std::ranges::find_if(finding.parameters, [](const FoundParameter& parameter) {
        const bool when = parameter.name == "start" || parameter.name == "end";
        return parameter.low < parameter.high && !when;
    });
    if (measured == finding.parameters.end()) {
        return "";
    }
    const bool any_change = measured->name.starts_with("delta_") && measured->low <= 0 && measured->high >= 0;
    // chooses the component of a vector, or the direction, with the smallest relative interval; for a link
    // error whose first parameter may be 0, any of its parameters
    const auto known = [&](const FoundParameter& parameter) {
        const double reach = parameter.high - parameter.low;
        return reach > 0 && (any_change || are_parts_of_one(parameter.name, measured->name))
                   ? std::abs(parameter.value) / reach
                   : 0;
    };
    const auto best = std::ranges::max_element(measured, finding.parameters.end(), {}, known);
    return parameter_words(*best);
}

std::string cause_words(const Finding& finding) {
    std::string text = words(finding.effect, finding.where);
    return finding.detail.empty() ? text : text.append(", ").append(finding.detail);
}

std::string tie_words(const Finding& finding) {
    constexpr std::size_t most_named = 3;
    const std::size_t named = std::min(most_named, finding.indistinguishable.size());
    std::string text;
    for (std::size_t i = 0; i < named; ++i) {
        text.append(text.empty() ? "" : "; ").append(cause_words(finding.indistinguishable[i]));
    }
    const std::size_t others = finding.indistinguishable.size() - named;
    return others == 0 ? text : text + "; " + std::to_string(others) + (others == 1 ? " other" : " others");
}

std::string interval_words(const FoundParameter& parameter) {
    const std::string high = std::isinf(parameter.high) ? "∞" : rounded_text(parameter.high);
    return rounded_text(parameter.low) + " … " + high;
}

std::string nuisance_words(const NuisanceEstimate& nuisance) {
    std::string text = nuisance.where + " " + rounded_text(nuisance.parameter.value);
    text.append(" (").append(interval_words(nuisance.parameter)).append(")");
    return nuisance.given ? text.append(" instead of ").append(rounded_text(*nuisance.given)) : text;
}

std::string cause_words(const OtherCause& cause) { return words(cause.effect, cause.where); }

} // namespace dfdyn::tools
