// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/recording/panel_run.hpp"

#include "tests/diagnosis/panel/recording/panel_band.hpp"
#include "tools/base/text/error.hpp"
#include "tools/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tests {

using namespace tools;

namespace {

constexpr double tolerance = 0.15; // relative, of the strength
constexpr int most_simulations = 4;

PanelRun empty_run(const PanelSetup& setup, const Scenario& scenario) {
    const auto rows = static_cast<Eigen::Index>(scenario.recording.samples);
    PanelRun run;
    run.position = run.friction = run.torque = Eigen::MatrixXd(rows, setup.joints());
    run.shown = {run.position, run.position, run.position};
    run.output = Eigen::MatrixXd(rows, setup.outputs());
    return run;
}

/// Writes the measured motion of joint `joint` at one sample into a row.
void show(MotionRows& shown, Eigen::Index row, Eigen::Index joint, const SimulatedTruth& truth,
          const EncoderModel& encoders) {
    const double size = encoders.eccentricity[joint];
    const double angle = truth.motor_position[joint] + encoders.eccentricity_phase[joint];
    const double offset = encoders.offset ? (*encoders.offset)[joint] : 0;
    const double velocity = truth.motor_velocity[joint];
    const double slope = 1 + size * std::cos(angle);
    shown.position(row, joint) = truth.motor_position[joint] + offset + size * std::sin(angle);
    shown.velocity(row, joint) = slope * velocity;
    shown.acceleration(row, joint) =
        slope * truth.motor_acceleration[joint] - size * std::sin(angle) * velocity * velocity;
}

void hide(const DrawnEffect& effect, double size, Robot& robot, Scenario& scenario) {
    effect.hide(size, scenario);
    scenario.integration_rate_hz = std::max(scenario.integration_rate_hz, effect.integration_rate_hz);
    if (effect.rebuild) {
        effect.rebuild(robot);
    }
}

/// Subtracts a model with the companion's friction at its average level.
void subtract_steady_friction(Eigen::MatrixXd& difference, const PanelSetup& setup, const PanelRun& run,
                              const DrawnEffect& effect, double size) {
    const Eigen::Index joint = *effect.drifting_joint;
    for (Eigen::Index row = 0; row < difference.rows(); ++row) {
        const double steady =
            effect.drifting(size, run.time_s[static_cast<std::size_t>(row)], run.friction(row, joint));
        difference(row, joint) -= steady / setup.torque_constants[joint];
    }
}

/// Rates of the motion that the encoders measure, computed from rows of a recording. Vibrations of a soft
/// joint are filtered because they are faster than the rows and would be aliased.
MotionRows from_rows(const MotionRows& shown, double rate_hz) {
    MotionRows result = shown;
    const Eigen::Index rows = shown.position.rows();
    const auto reach = static_cast<Eigen::Index>(std::lround(0.03 * rate_hz));
    const double step = static_cast<double>(reach) / rate_hz;
    for (Eigen::Index row = 2 * reach; row + 2 * reach < rows; ++row) {
        const auto at = [&](Eigen::Index steps) { return shown.position.row(row + steps * reach); };
        // Differences of fourth order.
        result.velocity.row(row) = (at(-2) - 8 * at(-1) + 8 * at(1) - at(2)) / (12 * step);
        result.acceleration.row(row) =
            (-at(-2) + 16 * at(-1) - 30 * at(0) + 16 * at(1) - at(2)) / (12 * step * step);
    }
    return result;
}

/// Outputs minus those of the true arm's rigid body.
Eigen::MatrixXd unexplained(const PanelSetup& setup, const PanelRun& run, const DrawnEffect& effect) {
    const MotionRows motion =
        effect.soft ? from_rows(run.shown, setup.scenario.recording.rate_hz) : run.shown;
    Eigen::MatrixXd rest = run.output - rigid_outputs(setup, setup.robot, motion);
    if (setup.ordinary_outputs.size() > 0) {
        rest -= setup.ordinary_outputs;
    }
    return rest;
}

Columns columns(std::vector<std::string> names, const Eigen::MatrixXd& rows) {
    Columns result;
    result.names = std::move(names);
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
        for (Eigen::Index column = 0; column < rows.cols(); ++column) {
            result.values.push_back(rows(row, column));
        }
    }
    return result;
}

void distort(const DrawnEffect& effect, double size, PanelRun& run) {
    if (effect.distort) {
        effect.distort(size, run);
    }
}

} // namespace

PanelRun run_panel(const PanelSetup& setup, const Robot& robot, const Scenario& scenario) {
    Simulation simulation(robot, scenario);
    PanelRun run = empty_run(setup, scenario);
    for (Eigen::Index row = 0; row < run.output.rows(); ++row) {
        const SimulatedSample sample = simulation.next();
        run.time_s.push_back(sample.time_s);
        run.position.row(row) = sample.position.transpose();
        run.friction.row(row) = sample.truth.friction.transpose();
        run.torque.row(row) = sample.torque.transpose();
        for (Eigen::Index joint = 0; joint < setup.joints(); ++joint) {
            show(run.shown, row, joint, sample.truth, scenario.encoders);
        }
        if (setup.wrench()) {
            run.output.row(row) = sample.wrench.transpose();
        } else {
            run.output.row(row) =
                sample.torque.cwiseQuotient(JointVector(setup.torque_constants)).transpose();
        }
    }
    return run;
}

Recording recording_of(const PanelSetup& setup, const PanelRun& run) {
    Recording recording;
    recording.source = "panel";
    recording.time_s = run.time_s;
    for (const double time_s : run.time_s) {
        recording.time_ns.push_back(std::llround(time_s * 1e9));
    }
    recording.position = columns(joint_names("q", setup.robot.joints.size()), run.position);
    recording.output =
        columns(output_names(setup.kind.outputs, setup.robot.joints.size()), run.output + setup.noise_rows);
    recording.gap_before.assign(recording.time_s.size(), 0);
    recording.gap_before.front() = 1;
    return recording;
}

Eigen::MatrixXd contribution(const PanelSetup& setup, const PanelRun& run, const DrawnEffect& effect,
                             double size) {
    Eigen::MatrixXd result = unexplained(setup, run, effect);
    if (effect.drifting) {
        subtract_steady_friction(result, setup, run, effect, size);
    }
    return result;
}

Eigen::VectorXd strengths(const PanelSetup& setup, const Eigen::MatrixXd& contribution) {
    return band_rms(contribution, setup.scenario.recording.rate_hz).cwiseQuotient(setup.noise_in_band);
}

std::optional<Fitted> fit_strength(const PanelSetup& setup, const DrawnEffect& effect, double strength) {
    Fitted fitted;
    fitted.effect = effect;
    fitted.size = effect.guess < 3 * effect.largest ? std::min(effect.guess, effect.largest) : effect.guess;
    while (fitted.simulations < most_simulations) {
        if (!(fitted.size > 0 && fitted.size <= effect.largest)) {
            return std::nullopt;
        }
        Robot robot = setup.robot;
        Scenario scenario = setup.scenario;
        hide(effect, fitted.size, robot, scenario);
        ++fitted.simulations;
        try {
            fitted.run = run_panel(setup, robot, scenario);
            distort(effect, fitted.size, fitted.run);
        } catch (const InputError&) { // the arm is unstable, or a link would have no mass
            return std::nullopt;
        }
        const Eigen::VectorXd reached =
            strengths(setup, contribution(setup, fitted.run, effect, fitted.size));
        fitted.strength = reached.maxCoeff(&fitted.main_output);
        if (std::abs(fitted.strength / strength - 1) < tolerance) {
            if (fitted.size <= effect.smallest) {
                return std::nullopt;
            }
            fitted.companion_strength = strengths(setup, unexplained(setup, fitted.run, effect)).maxCoeff();
            return fitted;
        }
        fitted.size *= std::clamp(strength / fitted.strength, 0.02, 50.0);
    }
    return std::nullopt;
}

PanelRun run_effects(const PanelSetup& setup, const std::vector<const Fitted*>& effects) {
    Robot robot = setup.robot;
    Scenario scenario = setup.scenario;
    for (const Fitted* fitted : effects) {
        hide(fitted->effect, fitted->size, robot, scenario);
    }
    PanelRun run = run_panel(setup, robot, scenario);
    for (const Fitted* fitted : effects) {
        distort(fitted->effect, fitted->size, run);
    }
    return run;
}

PanelRun run_undisturbed(const PanelSetup& setup) {
    try {
        return run_panel(setup, setup.robot, setup.scenario);
    } catch (const InputError& error) { // the controller is unstable with this arm
        throw ImpossibleCase(error.what());
    }
}

} // namespace dfdyn::tests
