// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel/effects/panel_effect.hpp"
#include "tools/simulation/simulation.hpp"

#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tests {

/// A short simulation with one hidden effect and no noise: the sensors' readings and the truth.
struct EffectTrial {
    PanelSetup setup;
    DrawnEffect effect;
    double size = 0;
    std::vector<tools::SimulatedSample> samples;

    double parameter(const std::string& name) const {
        for (const auto& [parameter_name, value] : effect.parameters(size)) {
            if (parameter_name == name) {
                return value;
            }
        }
        return 0;
    }
    /// The joint's index, from the number at the end of `where`.
    Eigen::Index joint() const {
        return std::stoi(effect.where.substr(effect.where.find_first_of("0123456789"))) - 1;
    }
};

/// Simulates the effect `name` at `rate_hz` rows per second. Its strength is at most 10 by its own estimate.
inline EffectTrial try_effect(const std::string& name, const std::string& robot, std::uint64_t seed,
                              double rate_hz = 200) {
    PanelMix mix;
    mix.robot = robot;
    mix.noise = "white";
    EffectTrial trial{make_panel_setup(seed, mix), {}, 0, {}};
    trial.setup.duration_s = 12;
    trial.setup.constants_known = true;
    trial.setup.scenario.recording.rate_hz = rate_hz;
    Draw draw(seed, 77);
    while (!(trial.size > 0)) {
        trial.effect = *draw_effect(name, {trial.setup, draw, 10});
        trial.size = std::min(trial.effect.guess, trial.effect.largest / 2);
    }
    tools::Robot arm = trial.setup.robot;
    tools::Scenario scenario = trial.setup.scenario;
    scenario.encoders.bits_per_turn = 30;
    trial.effect.hide(trial.size, scenario);
    scenario.integration_rate_hz = std::max(scenario.integration_rate_hz, trial.effect.integration_rate_hz);
    if (trial.effect.rebuild) {
        trial.effect.rebuild(arm);
    }
    tools::Simulation simulation(arm, scenario);
    for (double time_s = 0; time_s < trial.setup.duration_s; time_s += 1 / rate_hz) {
        trial.samples.push_back(simulation.next());
    }
    return trial;
}

} // namespace dfdyn::tests
