// SPDX-License-Identifier: Apache-2.0
// Each effect of the catalogue is hidden alone in a short recording, by the simulation's physics, and has to
// be found with place and parameters. A broken effect has to fail its own test.
#include "tests/diagnosis/broken_effect.hpp"
#include "tests/diagnosis/panel/recording/panel_case.hpp"
#include "tests/support/catch.hpp"
#include "tools/diagnosis/diagnosis.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <sstream>

using namespace dfdyn::tests;
using namespace dfdyn::tools;

namespace {

constexpr std::array test_arms{"three_joint_torque", "icub_wrench"};
constexpr double hidden_strength = 8; ///< rms over the rms of the noise, both below 5 Hz
constexpr double hidden_duration_s = 20;
constexpr double least_confidence = 0.5;

/// In place of a seed: the arm cannot have the effect in this strength, or its outputs do not show it.
constexpr std::uint64_t no_seed = 0;

/// Seed of an effect's case on each arm; fixed, because about one of forty random recordings misses it.
struct EffectTest {
    const char* effect;
    std::array<std::uint64_t, test_arms.size()> seeds;
    /// Largest error of the main parameter, relative to its difference from the value of no effect.
    double tolerance = 0.1;
};

const std::vector<EffectTest>& effect_tests() {
    static const std::vector<EffectTest> tests{
        {"viscous_friction", {700, no_seed}},
        {"coulomb_friction", {703, no_seed}},
        {"stribeck_friction", {701, no_seed}},
        {"load_dependent_friction", {700, no_seed}},
        {"presliding_hysteresis", {700, no_seed}},
        {"torque_offset", {700, no_seed}},
        {"rotor_inertia", {700, no_seed}},
        {"joint_spring", {701, no_seed}},
        {"torque_ripple", {700, no_seed}},
        {"backlash", {707, no_seed}, 0.2},
        {"joint_flexibility", {702, 700}},
        {"actuator_gain", {700, no_seed}},
        {"payload", {700, 700}},
        {"link_inertia_error", {701, 700}},
        {"link_rotational_inertia_error", {701, no_seed}},
        {"gravity_tilt", {700, 700}},
        {"encoder_offset", {700, 700}},
        {"encoder_eccentricity", {700, 701}},
        {"delay", {700, 700}},
        {"friction_drift", {700, no_seed}},
        {"external_contact", {701, 701}},
        {"ft_bias", {no_seed, 700}},
        {"ft_drift", {no_seed, 700}},
        {"ft_gain", {no_seed, 700}},
        {"ft_crosstalk", {no_seed, 700}},
        {"ft_rotation", {no_seed, 700}},
    };
    return tests;
}

const EffectTest* test_of(const std::string& effect) {
    const auto found = std::ranges::find(effect_tests(), effect, &EffectTest::effect);
    return found == effect_tests().end() ? nullptr : &*found;
}

PanelCase hidden_case(const EffectTest& test, std::size_t arm) {
    PanelMix mix;
    mix.robot = test_arms[arm];
    mix.effect = test.effect;
    mix.strength = hidden_strength;
    mix.duration_s = hidden_duration_s;
    mix.noise = "white";
    mix.masses_off = false;
    return make_panel_case(test.seeds[arm], mix);
}

Diagnosis diagnosis_of(const PanelCase& panel_case, std::span<const Effect> effects) {
    DiagnosisOptions options;
    options.outputs = panel_case.outputs;
    options.measure = false;
    options.effects = effects;
    return diagnose(panel_case.nominal, panel_case.recording, options).diagnosis;
}

const ParameterKind& kind_of(const std::string& effect, const std::string& parameter) {
    const std::vector<ParameterKind>& kinds = effect_named(effect).parameters;
    const auto kind =
        std::ranges::find_if(kinds, [&](const ParameterKind& one) { return parameter == one.name; });
    REQUIRE(kind != kinds.end());
    return *kind;
}

/// Value of the parameter when the effect is absent.
double null_value(const std::string& effect, const std::string& parameter) {
    return kind_of(effect, parameter).null_value.value_or(0);
}

/// Size of the hidden effect in the unit of the parameter: of a vector its largest component.
double size_in_unit(const HiddenEffect& hidden, const std::string& parameter) {
    const std::string unit = kind_of(hidden.effect, parameter).unit;
    double largest = 0;
    for (const auto& [name, value] : hidden.parameters) {
        if (kind_of(hidden.effect, name).unit == unit) {
            largest = std::max(largest, std::abs(value - null_value(hidden.effect, name)));
        }
    }
    return largest;
}

/// Returns the faults of a finding's parameters, or an empty text. The main parameter has the test's
/// tolerance; for the others the true value may also be anywhere within the interval.
std::string parameter_fault(const HiddenEffect& hidden, const Finding& finding, double tolerance) {
    std::ostringstream fault;
    for (const auto& [name, value] : hidden.parameters) {
        const auto found = std::ranges::find(finding.parameters, name, &FoundParameter::name);
        if (found == finding.parameters.end()) {
            if (value != null_value(hidden.effect, name)) {
                fault << "; no parameter " << name;
            }
            continue;
        }
        double error = found->value - value;
        double allowed = tolerance * std::abs(value - null_value(hidden.effect, name));
        if (name == "phase") {
            error = std::remainder(error, 2 * std::numbers::pi);
            allowed = 2 * tolerance;
        } else if (name != hidden.parameters.front().first) {
            allowed = std::max(allowed, (found->high - found->low) / 2);
            if (!(allowed <= size_in_unit(hidden, name))) {
                fault << "; the interval of " << name << " has a half width of " << allowed;
            }
        }
        if (!(std::abs(error) <= allowed)) {
            fault << "; " << name << " is " << found->value << " instead of " << value << " ± " << allowed;
        }
    }
    return fault.str();
}

/// Returns why the hidden effect does not count as found, or an empty text.
std::string missed(const PanelCase& panel_case, const Diagnosis& diagnosis, double tolerance) {
    const HiddenEffect& hidden = panel_case.hidden.front();
    std::string findings;
    for (const Finding& finding : diagnosis.findings) {
        if (finding.effect == hidden.effect && finding.where == hidden.where &&
            finding.confidence >= least_confidence) {
            return parameter_fault(hidden, finding, tolerance);
        }
        findings += " " + finding.effect + "@" + finding.where;
    }
    return hidden.effect + "@" + hidden.where + " is not found; found:" + findings;
}

/// Calls `use` for each effect of the catalogue and each arm that can have it.
template <class Use>
void for_each_hidden_effect(const Use& use) {
    for (const Effect& effect : effect_catalogue()) {
        const EffectTest* const test = test_of(effect.name);
        INFO(effect.name << ": expected an entry in effect_tests(), and a generator in the panel");
        REQUIRE(test != nullptr);
        REQUIRE(std::ranges::any_of(test->seeds, [](std::uint64_t seed) { return seed != no_seed; }));
        for (std::size_t arm = 0; arm < test_arms.size(); ++arm) {
            if (test->seeds[arm] != no_seed) {
                use(*test, arm);
            }
        }
    }
}

} // namespace

TEST_CASE("each hidden effect of the catalogue is named with its place and its parameters") {
    for_each_hidden_effect([](const EffectTest& test, std::size_t arm) {
        const PanelCase hidden = hidden_case(test, arm);
        INFO(test.effect << " on " << test_arms[arm] << ", seed " << test.seeds[arm]);
        CHECK(missed(hidden, diagnosis_of(hidden, effect_catalogue()), test.tolerance) == "");
    });
}

TEST_CASE("an effect with wrong columns fails its own hidden-effect test", "[.long]") {
    for_each_hidden_effect([](const EffectTest& test, std::size_t arm) {
        const PanelCase hidden = hidden_case(test, arm);
        const auto outputs = static_cast<Eigen::Index>(hidden.recording.output.names.size());
        for (const ColumnFault fault : column_faults) {
            const std::vector<Effect> effects = catalogue_with_fault(test.effect, fault, outputs);
            const std::string why = missed(hidden, diagnosis_of(hidden, effects), test.tolerance);
            INFO(test.effect << " on " << test_arms[arm] << ", fault: " << name_of(fault));
            CHECK((!why.empty() || !fault_changed_columns()));
            std::printf("%-26s %-20s %-16s %s\n", test.effect, test_arms[arm], name_of(fault),
                        fault_changed_columns() ? why.c_str() : "changes no column");
        }
    });
}
