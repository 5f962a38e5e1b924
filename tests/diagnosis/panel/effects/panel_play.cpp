// SPDX-License-Identifier: Apache-2.0
// Backlash whose link never falls freely: grease in the gap, and friction at the link, let it change flanks
// slowly. The encoder is on the motor. Unlike the gear of panel_gear_effects.cpp there is no impact.
#include "tests/diagnosis/panel/effects/panel_effect.hpp"

#include "tests/diagnosis/panel/recording/panel_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace dfdyn::tests {

using namespace tools;

namespace {

struct GreasedGear {
    Eigen::Index joint;
    double load;          ///< rms of the joint's torque, N·m
    double counts_a_turn; ///< of the encoder
    /// A soft gear holds the link between its flanks under a small load: share of `load` for 0.7 of a
    /// flank. Otherwise the load pushes the link across the gap at a speed in proportion to it.
    std::optional<double> wide;
    double time_s; ///< with which the link follows on a soft gear, or takes across the gap under `load`

    /// Moves the motor, whose position the encoder reads, ahead of the link by up to half of `gap`.
    void take_apart(double gap, PanelRun& run) const;
};

void GreasedGear::take_apart(double gap, PanelRun& run) const {
    const double count = 2 * std::numbers::pi / counts_a_turn;
    const auto settled = [&](Eigen::Index row) {
        const double relative = run.torque(row, joint) / (wide.value_or(0.01) * load);
        return relative / std::hypot(1, relative);
    };
    double flank = settled(0); // from -1 to 1
    for (Eigen::Index row = 0; row < run.position.rows(); ++row) {
        const auto index = static_cast<std::size_t>(row);
        const double steps = row == 0 ? 0 : (run.time_s[index] - run.time_s[index - 1]) / time_s;
        flank +=
            wide ? (settled(row) - flank) * -std::expm1(-steps) : 2 * steps * run.torque(row, joint) / load;
        flank = std::clamp(flank, -1.0, 1.0);
        run.shown.position(row, joint) += flank * gap / 2;
        run.position(row, joint) = count * std::round(run.shown.position(row, joint) / count);
    }
}

} // namespace

namespace hidden_effects {

/// In half of the cases dry friction at the link, which shows in the torque, decides with the load on which
/// flank the link is.
DrawnEffect greased_backlash(const EffectDraw& of) {
    const Eigen::Index joint = of.joint();
    const bool rubs = !of.setup.wrench() && of.draw.chance(0.5);
    const double share = of.draw.uniform(0.3, 1);
    const Eigen::VectorXd torque = joint_torque(of.setup, joint);
    GreasedGear gear{joint, rms(torque), std::exp2(of.setup.scenario.encoders.bits_per_turn), {}, 0};
    if (of.draw.chance(0.5)) {
        gear.wide = of.draw.log_uniform(0.02, 0.3);
        gear.time_s = of.draw.log_uniform(0.01, 0.08);
    } else {
        gear.time_s = of.draw.log_uniform(0.02, 0.15);
    }
    DrawnEffect effect;
    effect.effect = "backlash";
    effect.where = joint_place(joint);
    effect.soft = true;
    effect.largest = 0.05; // three degrees
    effect.parameters = [](double gap) { return EffectParameters{{"gap", gap}}; };
    Eigen::VectorXd load = torque;
    effect.hide = [](double, Scenario&) {};
    if (rubs) {
        const double level = share * gear.load;
        effect.companion = HiddenEffect{"coulomb_friction", effect.where, {{"coulomb", level}}, "", 0};
        effect.hide = [joint, level, inertia = least_inertia(of.setup, joint)](double, Scenario& scenario) {
            add_dry_friction(scenario, joint, level, stiff_bend, inertia);
        };
        effect.drifting_joint = joint;
        effect.drifting = [](double, double, double friction) { return friction; };
        load += level * of.setup.reference.velocity.col(joint).cwiseSign();
    }
    effect.distort = [gear](double gap, PanelRun& run) { gear.take_apart(gap, run); };
    effect.guess = guess_of_gap(of, joint, load);
    return effect;
}

} // namespace hidden_effects

} // namespace dfdyn::tests
