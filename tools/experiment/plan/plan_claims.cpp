// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/plan/plan_claims.hpp"

#include "tools/experiment/plan/plan_names.hpp"

#include <array>

namespace dfdyn::tools {

namespace {

constexpr std::array<std::string_view, 2> figure_names{"title", "cases"};
constexpr std::array<std::string_view, 5> comparison_names{"better", "worse", "group", "phase", "gain"};
constexpr std::array<std::string_view, 4> finding_names{"name", "statement", "if_not", "comparisons"};

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& list) {
    std::vector<std::string> names;
    std::ranges::transform(list, std::back_inserter(names), &Named::name);
    return names;
}

std::vector<Figure> figures(const JsonReader& json, const Plan& plan) {
    std::vector<Figure> all;
    if (!json.has("figures")) {
        all.push_back({plan.title, names_of(plan.cases)});
    }
    for (const char* field : {"figures", "more_figures"}) {
        if (!json.has(field)) {
            continue;
        }
        for (const JsonReader& figure : json.objects(field, 1, most_entries)) {
            figure.allow_only(figure_names);
            all.push_back({figure.text("title"), names_in(figure, "cases")});
            for (const std::string& name : all.back().cases) {
                known(figure, "cases", plan.cases, name);
            }
        }
    }
    return all;
}

Phase phase_of(const JsonReader& entry) {
    const std::string text = entry.text("phase");
    for (const Phase phase : {Phase::transient, Phase::steady}) {
        if (text == to_string(phase)) {
            return phase;
        }
    }
    throw entry.error("phase", "transient or steady", in_quotes(text));
}

/// Returns the cases named in the entry; those of a set in the plan's order.
std::vector<std::string> cases_in(const JsonReader& entry, const std::string& field, const Plan& plan) {
    std::vector<std::string> cases;
    for (const std::string& name : names_in(entry, field)) {
        if (name != set_of_the_paper) {
            cases.push_back(known(entry, field, plan.cases, name));
            continue;
        }
        for (const Case& one : plan.cases) {
            if (one.suffix.empty()) {
                cases.push_back(one.name);
            }
        }
    }
    return cases;
}

/// Adds every combination of the entry's lists.
void expand_comparison(const JsonReader& entry, const Plan& plan, std::vector<Comparison>& all) {
    entry.allow_only(comparison_names);
    const Phase phase = phase_of(entry);
    const double gain = entry.has("gain") ? entry.number_within("gain", -10, 0.99) : 0;
    const std::vector<std::string> groups =
        entry.has("group") ? names_in(entry, "group") : names_of(plan.groups);
    const std::vector<std::string> worse_cases = cases_in(entry, "worse", plan);
    for (const std::string& better : cases_in(entry, "better", plan)) {
        for (const std::string& worse : worse_cases) {
            for (const std::string& group : groups) {
                all.push_back({better, worse, known(entry, "group", plan.groups, group), phase, gain});
            }
        }
    }
}

std::vector<Comparison> comparisons(const JsonReader& reader, const Plan& plan) {
    std::vector<Comparison> all;
    for (const JsonReader& entry : reader.objects("comparisons", 1, most_entries)) {
        expand_comparison(entry, plan, all);
    }
    return all;
}

void add_findings(const JsonReader& json, const std::string& field, Plan& plan) {
    if (!json.has(field)) {
        return;
    }
    for (const JsonReader& finding : json.objects(field, 1, most_entries)) {
        finding.allow_only(finding_names);
        plan.findings.push_back({finding.text("name"), finding.text("statement"),
                                 finding.has("if_not") ? finding.text("if_not") : "",
                                 comparisons(finding, plan)});
        refuse_twice(json, field, plan.findings);
    }
}

} // namespace

void read_claims(const JsonReader& json, Plan& plan) {
    plan.figures = figures(json, plan);
    if (json.has("comparisons")) {
        plan.comparisons = comparisons(json, plan);
    }
    add_findings(json, "findings", plan);
    add_findings(json, "more_findings", plan);
}

} // namespace dfdyn::tools
