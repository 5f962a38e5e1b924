// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel_effect.hpp"

namespace dfdyn::tests {

/// A simulation without noise.
struct PanelRun {
    std::vector<double> time_s;
    Eigen::MatrixXd position; ///< as the encoders show it, quantised
    MotionRows shown;       ///< the same without the quantiser, and what the encoders would show of its rates
    Eigen::MatrixXd output; ///< in the recording's units
    Eigen::MatrixXd friction; ///< N·m, per joint
};

/// Throws InputError when the arm runs away.
PanelRun run_panel(const PanelSetup& setup, const tools::Robot& robot, const tools::Scenario& scenario);

/// What may be seen of it: positions, and the outputs with the setup's noise.
tools::Recording recording_of(const PanelSetup& setup, const PanelRun& run);

/// What the effect adds: the outputs less what the true arm without it would show on the same motion.
Eigen::MatrixXd contribution(const PanelSetup& setup, const PanelRun& run, const DrawnEffect& effect,
                             double size);

/// rms of `contribution` / rms of the noise, both in band, per output.
Eigen::VectorXd strengths(const PanelSetup& setup, const Eigen::MatrixXd& contribution);

/// A size at which the effect alone has its strength, within 15 %.
struct Fitted {
    DrawnEffect effect;
    double size = 0, strength = 0;
    Eigen::Index main_output = 0;
    double companion_strength = 0;
    PanelRun run;
    int simulations = 0;
};

/// Nothing where physics does not allow it.
std::optional<Fitted> fit_strength(const PanelSetup& setup, const DrawnEffect& effect, double strength);

/// The scenario and the arm of several effects at once.
PanelRun run_effects(const PanelSetup& setup, const std::vector<const Fitted*>& effects);

} // namespace dfdyn::tests
