// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/plan/plan_cases.hpp"

#include "tools/base/text/text.hpp"
#include "tools/experiment/plan/plan_names.hpp"
#include "tools/model/effects.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/model/structure.hpp"

#include <algorithm>
#include <array>

namespace dfdyn::tools {

namespace {

constexpr std::array<std::string_view, 2> hypers{"ML", "CV"};
constexpr std::array<std::string_view, 2> physics_inputs{"same", "own"};
constexpr std::array<std::string_view, 3> priors{"scaled", "unit", "diagonal"};

constexpr std::array<std::string_view, 12> setting_names{
    "physics_input", "effects",         "prior",  "lags",           "features",  "orthogonal",
    "forgetting",    "likelihood_rows", "starts", "rows_per_joint", "relevance", "centred"};
constexpr std::array<std::string_view, 2> combination_names{"combine", "name"};
constexpr std::array<std::string_view, 16> entry_names{
    "model",  "input",          "hyper",     "suffix",     "physics_input", "effects",
    "prior",  "lags",           "features",  "orthogonal", "forgetting",    "likelihood_rows",
    "starts", "rows_per_joint", "relevance", "centred"};

std::string one_of(const JsonReader& entry, const std::string& name, const std::string& text,
                   std::span<const std::string_view> known) {
    if (std::ranges::find(known, text) == known.end()) {
        const std::vector<std::string> names(known.begin(), known.end());
        throw entry.error(name, "one of " + listed(names), in_quotes(text));
    }
    return text;
}

std::string model_of(const JsonReader& entry, const std::string& text) {
    if (find_structure(text) == nullptr) {
        throw entry.error("model", "one of " + listed(structure_names()), in_quotes(text));
    }
    return text;
}

std::vector<std::string> names_or(const JsonReader& entry, const std::string& name,
                                  const std::string& fallback) {
    return entry.has(name) ? names_in(entry, name) : std::vector{fallback};
}

std::vector<int> rows_per_joint(const JsonReader& entry, int fallback) {
    if (!entry.has("rows_per_joint")) {
        return {fallback};
    }
    return entry.is_array("rows_per_joint") ? entry.whole_numbers("rows_per_joint", 1, 1001)
                                            : std::vector{entry.whole_number("rows_per_joint", 1, 1001)};
}

InputKind input_of(const JsonReader& entry, const std::string& text) {
    try {
        return parse_input_kind(text);
    } catch (const InputError&) {
        throw entry.error("input", "one of " + input_names(", "), in_quotes(text));
    }
}

std::vector<std::string> effects_of(const JsonReader& entry) {
    std::vector<std::string> effects = names_in(entry, "effects");
    for (const std::string& effect : effects) {
        if (find_effect_kind(effect) == nullptr) {
            throw entry.error("effects", "one of " + effect_names(), in_quotes(effect));
        }
    }
    return effects;
}

void read_settings(const JsonReader& entry, Case& one) {
    const auto whole = [&entry](const std::string& name, int high, int& value) {
        value = entry.whole_or(name, value, 1, high);
    };
    whole("lags", 1000, one.lags);
    whole("features", 5000, one.feature_count);
    whole("likelihood_rows", 20000, one.likelihood_rows);
    whole("starts", 1000, one.starts);
    const auto flag = [&entry](const std::string& name, bool& value) {
        value = entry.has(name) ? entry.flag(name) : value;
    };
    flag("orthogonal", one.orthogonal);
    flag("relevance", one.relevance);
    flag("centred", one.centred);
    one.forgetting_factor = entry.number_or("forgetting", one.forgetting_factor, 0.5, 1);
    if (entry.has("physics_input")) {
        one.physics_input = one_of(entry, "physics_input", entry.text("physics_input"), physics_inputs);
    }
    if (entry.has("prior")) {
        one.prior = one_of(entry, "prior", entry.text("prior"), priors);
    }
    if (entry.has("effects")) {
        one.effects = effects_of(entry);
    }
}

/// Reads an entry with "combine".
Case combination_of(const JsonReader& entry) {
    entry.allow_only(combination_names);
    Case one;
    one.name = one.suffix = plain_name(entry, "name");
    if (one.name == set_of_the_paper) { // no comparison could refer to it
        throw entry.error("name", "another name than that of the set of all cases without a suffix",
                          in_quotes(one.name));
    }
    one.members = names_in(entry, "combine");
    one.lags = 0; // the members have their own windows
    return one;
}

std::string case_name(const JsonReader& entry, const Case& one) {
    std::string name = one.model + "-" + one.hyper + "-" + input_description(one.input).name;
    if (entry.has("rows_per_joint") && entry.is_array("rows_per_joint")) {
        name += "-k" + std::to_string(one.rows_per_joint);
    }
    return name + one.suffix;
}

} // namespace

Case read_defaults(const JsonReader& entry) {
    entry.allow_only(setting_names);
    Case one;
    read_settings(entry, one);
    if (entry.has("rows_per_joint")) {
        one.rows_per_joint = entry.whole_number("rows_per_joint", 1, 1001);
    }
    return one;
}

std::vector<Case> expand_cases(const JsonReader& entry, const Case& defaults) {
    if (entry.has("combine")) {
        return {combination_of(entry)};
    }
    entry.allow_only(entry_names);
    Case one = defaults;
    read_settings(entry, one);
    one.suffix = entry.has("suffix") ? plain_name(entry, "suffix") : "";
    std::vector<Case> cases;
    for (const std::string& model : names_or(entry, "model", defaults.model)) {
        one.model = model_of(entry, model);
        for (const std::string& hyper : names_or(entry, "hyper", defaults.hyper)) {
            one.hyper = one_of(entry, "hyper", hyper, hypers);
            for (const std::string& input :
                 names_or(entry, "input", std::string(input_description(defaults.input).name))) {
                one.input = input_of(entry, input);
                for (const int rows : rows_per_joint(entry, defaults.rows_per_joint)) {
                    one.rows_per_joint = rows;
                    one.name = case_name(entry, one);
                    cases.push_back(one);
                }
            }
        }
    }
    return cases;
}

} // namespace dfdyn::tools
