// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/effects/effect_catalogue.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tests/tools/support/name_literals.hpp"
#include "tests/tools/support/project.hpp"
#include "tools/base/system/read_file.hpp"
#include "tools/model/effects.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

/// Parameters as documented, for example `amplitude (N·m), phase (rad)`. Names of the same unit share one
/// unit.
std::string listed(const std::vector<ParameterKind>& parameters) {
    std::string text;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const std::string unit = parameters[i].unit;
        const bool last_of_unit = i + 1 == parameters.size() || unit != parameters[i + 1].unit;
        text.append(text.empty() ? "" : ", ").append(parameters[i].name);
        text += last_of_unit && !unit.empty() ? " (" + unit + ")" : "";
    }
    return text;
}

std::string documented_row(const Effect& effect) {
    return std::string("| `") + effect.name + "` | " + effect.where + " | " + listed(effect.parameters) +
           effect.remark + " | " + effect.in_extended_model + " |\n";
}

} // namespace

TEST_CASE("the name of an effect is a literal only in its own file and in the catalogues") {
    // The firmware's columns, the monitor's changes and the simulation's faults have names of their own.
    const std::set<std::string> catalogues{"tools/model/effects.cpp",
                                           "firmware_lib/include/dfdyn/monitor/cause.hpp",
                                           "tools/simulation/faults/actuator_gain.cpp"};
    std::set<std::string> effects;
    for (const Effect& effect : effect_catalogue()) {
        effects.insert(effect.name);
    }
    std::set<std::string> seen;
    for (const auto& [file, names] : files_with_names(effects)) {
        for (const std::string& name : names) {
            CAPTURE(file, name);
            const bool own = file == "tools/diagnosis/effects/" + name + ".cpp";
            CHECK((own || catalogues.contains(file)));
            if (own) {
                seen.insert(name);
            }
        }
    }
    CHECK(seen.size() == effect_catalogue().size());
}

TEST_CASE("the table of effects in the documentation equals the catalogue") {
    const std::string text = read_file(project / "docs/guide/diagnosis.md");
    const std::string rule = "| --- | --- | --- | --- |\n";
    const std::size_t first = text.find(rule, text.find("| effect | where |")) + rule.size();
    std::string expected;
    for (const Effect& effect : effect_catalogue()) {
        expected += documented_row(effect);
    }
    CHECK(text.substr(first, text.find("\n\n", first) + 1 - first) == expected);
}

TEST_CASE("every effect column of the firmware is in the catalogue of effects") {
    int checked = 0;
    std::istringstream names(effect_names());
    for (std::string name; names >> name; ++checked) {
        name.erase(name.find_last_not_of(',') + 1);
        CAPTURE(name);
        CHECK(find_effect(name) != nullptr);
    }
    CHECK(checked >= 8);
}

TEST_CASE("candidates have the places and parameters that the catalogue lists for their effect") {
    const DiagnosisSignals torques = signals_of(ur5(), OutputKind::joint_torque);
    const DiagnosisSignals wrench = signals_of(icub_right_arm(), OutputKind::wrench);
    std::set<std::string> seen;
    for (const DiagnosisSignals* const signals : {&torques, &wrench}) {
        std::vector<Candidate> candidates = static_candidates(*signals);
        std::vector<Candidate> fitted = fitted_candidates(*signals, rigid_model(*signals));
        candidates.insert(candidates.end(), fitted.begin(), fitted.end());
        for (const Candidate& candidate : candidates) {
            CAPTURE(candidate.key());
            const Effect& effect = effect_named(candidate.effect);
            seen.insert(effect.name);
            const std::string place = candidate.where.substr(0, candidate.where.find_first_of("123456789"));
            CHECK(std::string_view(effect.where).find(place) != std::string_view::npos);
            for (const EffectShape& shape : candidate.shapes) {
                const auto count = static_cast<Eigen::Index>(shape.columns.size());
                for (const EffectParameter& parameter :
                     candidate.parameters(Eigen::VectorXd::Ones(count), shape)) {
                    const auto kind = std::ranges::find_if(effect.parameters, [&](const ParameterKind& one) {
                        return parameter.name == one.name;
                    });
                    CAPTURE(parameter.name);
                    CHECK(kind != effect.parameters.end());
                }
            }
        }
    }
    for (const Effect& effect : effect_catalogue()) {
        CAPTURE(effect.name); // friction drift needs friction; scanned effects need a search
        CHECK((seen.contains(effect.name) || effect.scan != nullptr || effect.each == Each::torque_joint));
    }
}
