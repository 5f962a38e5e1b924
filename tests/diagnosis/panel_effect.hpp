// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel_setup.hpp"

#include <functional>
#include <optional>

namespace dfdyn::tests {

/// An effect at a place, with its shape, whose size is still open. Sizes are positive; signs are part of the
/// shape.
struct DrawnEffect {
    std::string effect, where;
    std::string depends_on; ///< outside the catalogue: an input
    std::function<void(double size, tools::Scenario&)> hide;
    std::function<EffectParameters(double size)> parameters; ///< main parameter first
    std::function<void(tools::Robot&)> rebuild;              ///< of the arm that is simulated; may be none
    bool soft = false;                                       ///< encoders vibrate against links
    double guess = 0;                                        ///< size that may have the strength wanted
    double smallest = 0;                                     ///< below it, it would be none
    double largest = 0;                                      ///< that physics, or good sense, allows
    double integration_rate_hz = 2000;                       ///< at least
    /// What belongs to the model it is compared with, in N·m on a joint, from the friction that was really
    /// there: the drift of friction is compared with the same friction without drift.
    std::function<double(double size, double time_s, double friction)> drifting;
    std::optional<Eigen::Index> drifting_joint;
    std::optional<HiddenEffect> companion; ///< what has to be there with it
};

/// What a draw depends on.
struct EffectDraw {
    const PanelSetup& setup;
    Draw& draw;
    double strength;

    Eigen::Index joint() const { return static_cast<Eigen::Index>(draw.below(setup.robot.joints.size())); }
    /// In-band rms that the effect should have on a joint's torque, N·m.
    double wanted(Eigen::Index joint) const {
        return strength * setup.noise_in_band[joint] * setup.torque_constants[joint];
    }
};

/// Outside of the catalogue; nothing for a name that is none of those.
std::optional<DrawnEffect> draw_outside_effect(const std::string& name, const EffectDraw& of);

/// Of any of them. Throws InputError for an unknown name.
std::optional<DrawnEffect> draw_effect(const std::string& name, const EffectDraw& of);

/// Whether it can show on these outputs.
bool shows(const std::string& effect, tools::OutputKind outputs, bool constants_known);

inline constexpr double stiff_bend = 5e-4; ///< rad
/// Bristles that bend by `bend` (rad) before `level` (N·m) slips: not faster than `fastest` (rad/s) against
/// `inertia`, which the integration's step has to follow; 600 is for half a millisecond. The controller damps
/// them: of their own damping every reversal would have a bump as high as Coulomb's friction.
void add_bristles(tools::LuGreParameters& friction, double level, double bend, double inertia,
                  double fastest = 600);

/// rms over the reference motion of one joint's column.
double rms(const Eigen::VectorXd& column);

/// The size that gives an effect of link, tip or encoder the wanted strength along the reference motion.
double guess_along_reference(const EffectDraw& of, const std::function<void(double, tools::Scenario&)>& hide,
                             double small);

/// The strength along the reference motion when the links really go along `real`.
double strength_along_reference(const PanelSetup& setup, const MotionRows& real);

std::string joint_place(Eigen::Index joint);

} // namespace dfdyn::tests
