// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/recording/panel_band.hpp"
#include "tests/diagnosis/panel/recording/panel_run.hpp"

#include "tools/base/text/error.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tests {

using namespace tools;

namespace {

const std::vector<double> strengths_drawn{0.3, 1, 3, 10};

enum class Kind { null, one, two, outside };

Kind draw_kind(const PanelMix& mix, Draw& draw) {
    const double share = draw.uniform(0, 1);
    if (mix.effect) {
        const std::vector<std::string> outside = outside_effect_names();
        return std::ranges::count(outside, *mix.effect) > 0 ? Kind::outside : Kind::one;
    }
    if (share < mix.null_share) {
        return Kind::null;
    }
    if (share < mix.null_share + mix.two_effects_share) {
        return Kind::two;
    }
    return share < mix.null_share + mix.two_effects_share + mix.outside_share ? Kind::outside : Kind::one;
}

std::vector<std::string> candidates(const PanelSetup& setup, Kind kind) {
    std::vector<std::string> names;
    for (const std::string& name : kind == Kind::outside ? outside_effect_names() : panel_effect_names()) {
        if (shows(name, setup.kind.outputs, setup.constants_known) &&
            (setup.ordinary.empty() || fits_ordinary_gears(name))) {
            names.push_back(name);
        }
    }
    return names;
}

/// Draws effects until one of them can have the wanted strength. Throws InputError if none can.
Fitted draw_fitted(const PanelSetup& setup, const std::vector<std::string>& names, const PanelMix& mix,
                   Draw& draw, PanelCase& result) {
    const double strength = mix.strength.value_or(draw.of(strengths_drawn));
    for (int redraw = 0; redraw < setup.kind.conditions.most_redraws; ++redraw) {
        const std::string name = mix.effect.value_or(draw.of(names));
        const std::optional<DrawnEffect> effect = draw_effect(name, {setup, draw, strength});
        if (!effect) {
            throw InputError("effect: expected one that shows on the outputs of " + setup.kind.name +
                             ", found " + name);
        }
        if (std::optional<Fitted> fitted = fit_strength(setup, *effect, strength)) {
            result.simulations += fitted->simulations;
            return *std::move(fitted);
        }
        ++result.redraws;
    }
    throw ImpossibleCase("expected an effect that can have strength " + std::to_string(strength) +
                         ", found none");
}

void describe(const PanelSetup& setup, const Fitted& fitted, PanelCase& result) {
    const std::string output = setup.output_name(fitted.main_output);
    const double evidence = band_evidence(contribution(setup, fitted.run, fitted.effect, fitted.size),
                                          setup.noise_rows, setup.scenario.recording.rate_hz);
    result.hidden.push_back({fitted.effect.effect, fitted.effect.where, fitted.effect.parameters(fitted.size),
                             output, fitted.strength, evidence, fitted.effect.depends_on});
    if (fitted.effect.companion) {
        result.hidden.push_back(*fitted.effect.companion);
        result.hidden.back().main_output = output;
        result.hidden.back().strength = fitted.companion_strength;
    }
}

/// Draws two effects that are not the same at the same place.
PanelRun draw_two(const PanelSetup& setup, const PanelMix& mix, Draw& draw, PanelCase& result) {
    const std::vector<std::string> names = candidates(setup, Kind::two);
    const Fitted first = draw_fitted(setup, names, mix, draw, result);
    for (int redraw = 0; redraw < setup.kind.conditions.most_redraws; ++redraw) {
        const Fitted second = draw_fitted(setup, names, mix, draw, result);
        if (first.effect.effect == second.effect.effect || first.effect.where == second.effect.where) {
            ++result.redraws; // two kinds of friction on one joint could not be distinguished
            continue;
        }
        try {
            PanelRun run = run_effects(setup, {&first, &second});
            ++result.simulations;
            describe(setup, first, result);
            describe(setup, second, result);
            return run;
        } catch (const InputError&) {
            ++result.redraws;
        }
    }
    throw ImpossibleCase("expected two effects that can be there at once, found none");
}

PanelRun draw_run(const PanelSetup& setup, const PanelMix& mix, Draw& draw, PanelCase& result) {
    Kind kind = draw_kind(mix, draw);
    if (kind == Kind::outside && candidates(setup, kind).empty()) {
        kind = Kind::one;
    }
    if (kind == Kind::null) {
        ++result.simulations;
        return run_undisturbed(setup);
    }
    if (kind == Kind::two) {
        return draw_two(setup, mix, draw, result);
    }
    Fitted fitted = draw_fitted(setup, candidates(setup, kind), mix, draw, result);
    describe(setup, fitted, result);
    result.outside_catalogue = kind == Kind::outside;
    return std::move(fitted.run);
}

} // namespace

PanelCase make_panel_case(std::uint64_t seed, const PanelMix& mix) {
    const PanelSetup setup = make_panel_setup(seed, mix);
    PanelCase result;
    result.seed = seed;
    result.robot_name = setup.kind.name;
    result.urdf = setup.kind.urdf;
    result.tip = setup.kind.tip;
    result.outputs = setup.kind.outputs;
    result.noise = setup.noise;
    result.noise_rms.assign(setup.noise_rms.begin(), setup.noise_rms.end());
    result.torque_constants_known = setup.constants_known;
    if (setup.kind.outputs == OutputKind::motor_current) {
        result.torque_constants.assign(setup.torque_constants.begin(), setup.torque_constants.end());
    }
    result.masses_off = setup.masses_off;
    result.nominal = setup.nominal;
    result.mass_errors = setup.mass_errors;
    result.ordinary = setup.ordinary;
    Draw effects(seed, 3);
    result.recording = recording_of(setup, draw_run(setup, mix, effects, result));
    return result;
}

std::optional<PanelCase> make_possible_case(std::uint64_t seed, const PanelMix& mix) {
    try {
        return make_panel_case(seed, mix);
    } catch (const ImpossibleCase&) {
        return std::nullopt;
    }
}

} // namespace dfdyn::tests
