// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel/effects/panel_effect.hpp"

namespace dfdyn::tests {

/// A simulation without noise.
struct PanelRun {
    std::vector<double> time_s;
    Eigen::MatrixXd position; ///< quantised by the encoders
    MotionRows shown;         ///< without quantisation, with the rates that the encoders imply
    Eigen::MatrixXd output;   ///< in the units of the recording
    Eigen::MatrixXd friction; ///< N·m, per joint
    Eigen::MatrixXd torque;   ///< N·m, per joint
};

/// Simulates the scenario. Throws InputError if the arm becomes unstable.
PanelRun run_panel(const PanelSetup& setup, const tools::Robot& robot, const tools::Scenario& scenario);

/// Simulates the setup without hidden effects. Throws ImpossibleCase if the arm becomes unstable.
PanelRun run_undisturbed(const PanelSetup& setup);

/// The recording of a run: positions, and outputs with the setup's noise.
tools::Recording recording_of(const PanelSetup& setup, const PanelRun& run);

/// Contribution of the effect: outputs minus those of the true arm without it on the same motion.
Eigen::MatrixXd contribution(const PanelSetup& setup, const PanelRun& run, const DrawnEffect& effect,
                             double size);

/// Ratio of the rms of `contribution` to the rms of the noise per output, both below 5 Hz.
Eigen::VectorXd strengths(const PanelSetup& setup, const Eigen::MatrixXd& contribution);

/// An effect with the size that gives it its strength alone, within 15 %.
struct Fitted {
    DrawnEffect effect;
    double size = 0, strength = 0;
    Eigen::Index main_output = 0;
    double companion_strength = 0;
    PanelRun run;
    int simulations = 0;
};

/// Finds the size with the given strength. Returns nothing if physics does not allow it.
std::optional<Fitted> fit_strength(const PanelSetup& setup, const DrawnEffect& effect, double strength);

/// Simulates several effects at once.
PanelRun run_effects(const PanelSetup& setup, const std::vector<const Fitted*>& effects);

} // namespace dfdyn::tests
