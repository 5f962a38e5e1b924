// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tests {

/// By name and in the units of the effect's own description. Axes of a F/T sensor are 0 … 5 for fx … mz.
using EffectParameters = std::vector<std::pair<std::string, double>>;

/// What makes a recording differ from the arm's rigid body.
struct HiddenEffect {
    std::string effect, where;
    EffectParameters parameters; ///< main parameter first
    std::string main_output;     ///< where it is largest relative to the noise
    /// rms of what it adds there / rms of the noise there, both below 5 Hz; it alone, without other effects
    double strength = 0;
    /// Logarithm of the likelihood ratio to nothing, below 5 Hz, for someone who knows its exact course, the
    /// noise's spectrum and the arm: no method has more to decide by. 0 of the second of two effects.
    double evidence = 0;
    std::string depends_on = {}; ///< outside the catalogue: the input that it is a function of
};

/// A recording with its answer. Whoever is tested may see `nominal`, `recording`, `outputs` and, where
/// `torque_constants_known`, `torque_constants`.
struct PanelCase {
    std::uint64_t seed = 0;
    std::string robot_name, urdf, tip; ///< the file below tests/data/robots
    tools::Robot nominal;              ///< as it is believed to be
    tools::OutputKind outputs = tools::OutputKind::joint_torque;
    tools::Recording recording; ///< t, q and the outputs
    bool masses_off = false;
    std::vector<double> mass_errors; ///< per link: nominal over true, minus 1
    std::string noise;               ///< white, ar1_0.9, ar1_0.98 or resampled
    std::vector<double> noise_rms;   ///< per output, as asked for
    bool torque_constants_known = true;
    std::vector<double>
        torque_constants; ///< N·m/A, per joint, as the log believes them; empty for others than currents
    std::vector<HiddenEffect> hidden; ///< the one that was asked for first
    bool outside_catalogue = false;   ///< then hidden names no effect that diagnosis knows
    int redraws = 0;                  ///< effects that physics did not allow at the strength wanted
    int simulations = 0;
};

/// How the cases are drawn. Nulls first, then pairs, then effects outside the catalogue; the rest have one
/// effect.
struct PanelMix {
    double null_share = 0.5;
    double two_effects_share = 0.1;
    double outside_share = 0.1;
    double known_constants_share = 0.25; ///< of recordings of currents
    std::optional<std::string> effect;   ///< always this one
    std::optional<double> strength;      ///< always this one
    std::optional<std::string> robot, noise;
    std::optional<bool> masses_off;
    std::optional<double> duration_s; ///< of every recording; otherwise 40 to 60
};

/// Names that PanelMix::robot and PanelMix::noise may have.
std::vector<std::string> panel_robot_names();
std::vector<std::string> panel_noise_names();

/// Of the catalogue, those of random cases or all; and the kinds outside of it.
std::vector<std::string> panel_effect_names(bool all = false);
std::vector<std::string> outside_effect_names();

/// The case of `seed`: the same seed and mix give the same bytes. Throws InputError for a name that is
/// unknown, or an effect that does not show on the outputs asked for. Cost: one to five simulations of about
/// a second.
PanelCase make_panel_case(std::uint64_t seed, const PanelMix& mix = {});

} // namespace dfdyn::tests
