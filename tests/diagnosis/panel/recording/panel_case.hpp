// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/base/text/error.hpp"
#include "tools/robot/robot.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tests {

/// Names and values in the units of the effect's description. Axes of an F/T sensor are 0 to 5 for fx to mz.
using EffectParameters = std::vector<std::pair<std::string, double>>;

/// A difference between a recording and the nominal rigid body.
struct HiddenEffect {
    std::string effect, where;
    EffectParameters parameters; ///< main parameter first
    std::string main_output;     ///< output with the largest ratio to the noise
    /// Ratio of the rms of the contribution to the rms of the noise at `main_output`, both below 5 Hz, for
    /// this effect alone.
    double strength = 0;
    /// Logarithm of the likelihood ratio against no effect, below 5 Hz, if the arm, the effect's exact
    /// contribution and the noise spectrum are known. It bounds the evidence of every method. 0 for the
    /// second of two effects.
    double evidence = 0;
    std::string depends_on = {}; ///< input of an effect outside the catalogue
};

/// A recording with its true effects. A method under test may use `nominal`, `recording`, `outputs` and, if
/// `torque_constants_known` is set, `torque_constants`.
struct PanelCase {
    std::uint64_t seed = 0;
    std::string robot_name, urdf, tip; ///< file below tests/data/robots
    tools::Robot nominal;              ///< with the errors of the robot description
    tools::OutputKind outputs = tools::OutputKind::joint_torque;
    tools::Recording recording; ///< t, q and the outputs
    bool masses_off = false;
    std::vector<double> mass_errors; ///< per link: nominal over true, minus 1
    std::string noise;               ///< white, ar1_0.9, ar1_0.98 or resampled
    std::vector<double> noise_rms;   ///< rms per output as configured
    bool torque_constants_known = true;
    std::vector<double>
        torque_constants; ///< nominal values per joint, N·m/A; empty unless the outputs are currents
    std::vector<HiddenEffect> hidden; ///< first the effect that was requested
    /// Friction and rotors of all joints, which no test requires to be named; each name of them is right.
    std::vector<HiddenEffect> ordinary;
    bool outside_catalogue = false; ///< then `hidden` has no effect of the diagnosis's catalogue
    int redraws = 0;                ///< number of effects that could not reach the wanted strength
    int simulations = 0;
};

/// Shares of the kinds of cases, drawn in this order: no effect, two effects, an effect outside the
/// catalogue. All others have one effect.
struct PanelMix {
    double null_share = 0.5;
    double two_effects_share = 0.1;
    double outside_share = 0.1;
    double known_constants_share = 0.25; ///< share of the recordings of currents
    std::optional<std::string> effect;   ///< if set, every case has this effect
    std::optional<double> strength;      ///< if set, every effect has this strength
    std::optional<std::string> robot, noise;
    std::optional<bool> masses_off;
    std::optional<double> duration_s; ///< of every recording; 40 to 60 s if not set
};

/// PanelMix::robot of an arm that is drawn at random, with its motion, noise, rate and duration. Only on
/// request.
inline constexpr const char* unknown_arm = "unknown_arm";

/// Valid names for PanelMix::robot, besides `unknown_arm`, and for PanelMix::noise.
std::vector<std::string> panel_robot_names();
std::vector<std::string> panel_noise_names();

/// Names of the catalogue's effects (those of random cases, or all), and of the effects outside the
/// catalogue.
std::vector<std::string> panel_effect_names(bool all = false);
std::vector<std::string> outside_effect_names();

/// The arm and the motion of a case cannot have the requested effect in the requested strength.
class ImpossibleCase : public tools::InputError {
  public:
    using InputError::InputError;
};

/// Makes the case of `seed`; equal seeds and mixes give equal bytes. Throws InputError for an unknown name or
/// an effect that the requested outputs cannot show, ImpossibleCase as described there. Cost: one to five
/// simulations of about a second each.
PanelCase make_panel_case(std::uint64_t seed, const PanelMix& mix = {});

/// The case of `seed`, or nothing if it is impossible.
std::optional<PanelCase> make_possible_case(std::uint64_t seed, const PanelMix& mix);

} // namespace dfdyn::tests
