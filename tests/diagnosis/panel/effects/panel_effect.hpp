// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel/recording/panel_setup.hpp"

#include <functional>
#include <optional>

namespace dfdyn::tests {

struct PanelRun;

/// An effect with place and shape but without a size. Sizes are positive; signs belong to the shape.
struct DrawnEffect {
    std::string effect, where;
    std::string depends_on; ///< input of an effect outside the catalogue
    std::function<void(double size, tools::Scenario&)> hide;
    std::function<EffectParameters(double size)> parameters; ///< main parameter first
    std::function<void(tools::Robot&)> rebuild;              ///< changes the simulated arm; may be empty
    /// Changes what the encoders read in a run; may be empty.
    std::function<void(double size, PanelRun&)> distort;
    bool soft = false;                 ///< encoders move relative to links
    double guess = 0;                  ///< estimate of the size with the wanted strength
    double smallest = 0;               ///< smaller sizes count as no effect
    double largest = 0;                ///< largest size that is physically reasonable
    double integration_rate_hz = 2000; ///< minimum
    /// Part of the reference model, in N·m on a joint, computed from the true friction: the drift of friction
    /// is compared with the same friction without drift.
    std::function<double(double size, double time_s, double friction)> drifting;
    std::optional<Eigen::Index> drifting_joint;
    std::optional<HiddenEffect> companion; ///< another effect that this one requires
};

/// Inputs of a draw.
struct EffectDraw {
    const PanelSetup& setup;
    Draw& draw;
    double strength;

    Eigen::Index joint() const { return static_cast<Eigen::Index>(draw.below(setup.robot.joints.size())); }
    /// Wanted rms of the effect on a joint's torque below 5 Hz, N·m.
    double wanted(Eigen::Index joint) const {
        return strength * setup.noise_in_band[joint] * setup.torque_constants[joint];
    }
};

/// Draws an effect outside the catalogue. Returns nothing for any other name.
std::optional<DrawnEffect> draw_outside_effect(const std::string& name, const EffectDraw& of);

/// Draws any effect. Throws InputError for an unknown name.
std::optional<DrawnEffect> draw_effect(const std::string& name, const EffectDraw& of);

/// Returns whether the effect can change these outputs.
bool shows(const std::string& effect, tools::OutputKind outputs, bool constants_known);

/// Returns whether the effect can be hidden in an arm whose joints all have friction and rotors.
bool fits_ordinary_gears(const std::string& effect);

inline constexpr double stiff_bend = 5e-4; ///< rad
/// Adds LuGre bristles that bend by `bend` (rad) before `level` (N·m) slips. Their natural frequency against
/// `inertia` is at most `fastest` (rad/s), because the integration step must follow it; 600 suits half a
/// millisecond. The controller damps them: own damping would add a bump as high as Coulomb friction at every
/// reversal.
void add_bristles(tools::LuGreParameters& friction, double level, double bend, double inertia,
                  double fastest = 600);

/// Smallest inertia that the friction of a joint moves during the reference motion.
double least_inertia(const PanelSetup& setup, Eigen::Index joint);

/// Torque of a joint per row of the reference motion, N·m.
Eigen::VectorXd joint_torque(const PanelSetup& setup, Eigen::Index joint);

/// Adds dry friction whose bristles bend by `bend` (rad).
void add_dry_friction(tools::Scenario& scenario, Eigen::Index joint, double level, double bend,
                      double inertia);

/// Estimates the gap (rad) with the wanted strength if the link is always on the flank of its load (N·m, per
/// row of the reference motion). 0 if the load hardly reverses: then backlash is only an offset.
double guess_of_gap(const EffectDraw& of, Eigen::Index joint, const Eigen::VectorXd& load);

/// Root mean square of one joint's column over the reference motion.
double rms(const Eigen::VectorXd& column);

/// Estimates the size that gives an effect of link, tip or encoder its wanted strength along the reference
/// motion.
double guess_along_reference(const EffectDraw& of, const std::function<void(double, tools::Scenario&)>& hide,
                             double small);

/// Strength along the reference motion if the links really move along `real`.
double strength_along_reference(const PanelSetup& setup, const MotionRows& real);

std::string joint_place(Eigen::Index joint);

} // namespace dfdyn::tests
