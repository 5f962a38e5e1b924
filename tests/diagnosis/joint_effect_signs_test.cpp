// SPDX-License-Identifier: Apache-2.0
// Compares every simulated effect on joint torques with the name, unit and sign of its parameters.
#include "tests/diagnosis/effect_trial.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/robot/dynamics/arm_dynamics.hpp"

#include <cmath>
#include <numbers>

namespace {

using namespace dfdyn::tests;
using namespace dfdyn::tools;

const std::string robots[] = {"ur5_torque", "three_joint_torque"};

/// Torques of the nominal rigid body along the true motion.
JointVector rigid(const EffectTrial& trial, const SimulatedTruth& truth) {
    const ArmDynamics dynamics(trial.setup.robot, JointVector::Zero(truth.position.size()));
    ArmDynamics::Configuration configuration;
    dynamics.configure(truth.position, configuration);
    return dynamics.inverse(configuration, truth.velocity, truth.acceleration);
}

/// Checks that the effect adds `expected(sample)` to the torque of its joint and changes no other torque.
template <class Expected>
void check_addition(const EffectTrial& trial, double margin, const Expected& expected) {
    CAPTURE(trial.setup.kind.name, trial.effect.where, trial.size);
    for (const SimulatedSample& sample : trial.samples) {
        JointVector left = sample.torque - rigid(trial, sample.truth);
        left[trial.joint()] -= expected(sample);
        REQUIRE(left.cwiseAbs().maxCoeff() < margin);
    }
}

} // namespace

TEST_CASE("viscous friction opposes the motion and is proportional to the velocity") {
    for (const std::string& robot : robots) {
        const EffectTrial trial = try_effect("viscous_friction", robot, seed());
        check_addition(trial, 1e-9, [&](const SimulatedSample& sample) {
            return trial.parameter("viscous") * sample.truth.velocity[trial.joint()];
        });
    }
}

TEST_CASE("Coulomb friction opposes the motion with the level of its direction") {
    for (std::uint64_t trial_seed = seed(); trial_seed < seed() + 4; ++trial_seed) {
        const EffectTrial trial = try_effect("coulomb_friction", robots[trial_seed % 2], trial_seed);
        const double mean = trial.parameter("coulomb");
        const double asymmetric = trial.parameter("coulomb_pos");
        const double forward = asymmetric > 0 ? asymmetric : mean;
        const double backward = asymmetric > 0 ? trial.parameter("coulomb_neg") : mean;
        int sliding = 0;
        double past = 0;
        double slid = 0;
        for (const SimulatedSample& sample : trial.samples) {
            const double velocity = sample.truth.velocity[trial.joint()];
            const double added = (sample.torque - rigid(trial, sample.truth))[trial.joint()];
            REQUIRE(added < 1.001 * forward); // no bump at a reversal
            REQUIRE(added > -1.001 * backward);
            slid = velocity * past > 0 ? slid + std::abs(velocity) / 200 : 0;
            past = velocity;
            if (slid > 0.02) { // the bristles have reached their full deflection
                REQUIRE(added == Approx(velocity > 0 ? forward : -backward).epsilon(1e-3));
                ++sliding;
            }
        }
        CHECK(sliding > 200);
        CHECK((forward + backward) / 2 == Approx(mean));
    }
}

TEST_CASE("Stribeck friction is Coulomb friction at speed and approaches the static level near standstill") {
    const EffectTrial trial = try_effect("stribeck_friction", "three_joint_torque", seed());
    double largest = 0;
    double past = 0;
    double slid = 0;
    for (const SimulatedSample& sample : trial.samples) {
        const double velocity = sample.truth.velocity[trial.joint()];
        const double added = (sample.torque - rigid(trial, sample.truth))[trial.joint()];
        slid = velocity * past > 0 ? slid + std::abs(velocity) / 200 : 0;
        past = velocity;
        largest = std::max(largest, std::abs(added));
        if (slid > 0.05 && std::abs(velocity) > 3 * trial.parameter("stribeck_velocity")) {
            REQUIRE(added == Approx(std::copysign(trial.parameter("coulomb"), velocity)).epsilon(1e-2));
        }
    }
    CHECK(largest > trial.parameter("coulomb") * 1.01);
    CHECK(largest < trial.parameter("static") * 1.001);
}

TEST_CASE("load-dependent friction is a share of the torque through the gear and opposes the motion") {
    for (const std::string& robot : robots) {
        const EffectTrial trial = try_effect("load_dependent_friction", robot, seed());
        const double mu = trial.parameter("mu");
        double past = 0;
        double slid = 0;
        double squares = 0;
        double errors = 0;
        for (const SimulatedSample& sample : trial.samples) {
            const double load = rigid(trial, sample.truth)[trial.joint()];
            const double velocity = sample.truth.velocity[trial.joint()];
            const double added = sample.torque[trial.joint()] - load;
            slid = velocity * past > 0 ? slid + std::abs(velocity) / 200 : 0;
            past = velocity;
            if (slid > 0.05) { // the bristles follow a changing load after a short travel
                squares += added * added;
                errors += std::pow(added - std::copysign(mu * std::abs(load), velocity), 2);
            }
        }
        CAPTURE(trial.effect.where, mu);
        CHECK(squares > 0);
        CHECK(std::sqrt(errors / squares) < 0.12);
    }
}

TEST_CASE("presliding friction is a spring that yields at its break-away level") {
    const EffectTrial trial = try_effect("presliding_hysteresis", "ur5_torque", seed());
    const double level = trial.parameter("break_away");
    const double stiffness = trial.parameter("stiffness");
    double largest = 0;
    double start = 0;
    double speed = 0;
    double steepest = 0;
    double past = 0;
    for (const SimulatedSample& sample : trial.samples) {
        const double added = (sample.torque - rigid(trial, sample.truth))[trial.joint()];
        const double position = sample.truth.position[trial.joint()];
        const double velocity = sample.truth.velocity[trial.joint()];
        largest = std::max(largest, std::abs(added));
        if (velocity * speed > 0 && std::abs(position - start) > 1e-4) {
            steepest = std::max(steepest, (added - past) / (position - start));
        }
        past = added;
        start = position;
        speed = velocity;
    }
    CHECK(largest <= level * (1 + 1e-9));
    CHECK(largest > 0.95 * level);
    // Right after a reversal the bent bristles push back, so that the slope is at most doubled.
    CHECK(steepest > 0.9 * stiffness);
    CHECK(steepest < 2.02 * stiffness);
}

TEST_CASE("a torque offset is added to the reading") {
    const EffectTrial trial = try_effect("torque_offset", "ur5_torque", seed());
    check_addition(trial, 1e-9, [&](const SimulatedSample&) { return trial.parameter("offset"); });
}

TEST_CASE("rotor inertia adds a torque proportional to the joint's acceleration") {
    const EffectTrial trial = try_effect("rotor_inertia", "three_joint_torque", seed());
    check_addition(trial, 1e-8, [&](const SimulatedSample& sample) {
        return trial.parameter("inertia") * sample.truth.acceleration[trial.joint()];
    });
}

TEST_CASE("a joint spring pulls towards its rest position and the actuator holds against it") {
    const EffectTrial trial = try_effect("joint_spring", "ur5_torque", seed());
    check_addition(trial, 1e-8, [&](const SimulatedSample& sample) {
        return trial.parameter("stiffness") *
               (sample.truth.position[trial.joint()] - trial.parameter("rest"));
    });
}

TEST_CASE("torque ripple adds a sine of the position to the torque") {
    const EffectTrial trial = try_effect("torque_ripple", "three_joint_torque", seed());
    check_addition(trial, 1e-8, [&](const SimulatedSample& sample) {
        return trial.parameter("amplitude") *
               std::sin(trial.parameter("cycles_per_rev") * sample.truth.position[trial.joint()] +
                        trial.parameter("phase"));
    });
}

TEST_CASE("an actuator's gain is the true torque divided by the logged torque") {
    const EffectTrial trial = try_effect("actuator_gain", "ur5_torque", seed());
    for (const SimulatedSample& sample : trial.samples) {
        JointVector expected = sample.truth.torque;
        expected[trial.joint()] /= trial.parameter("gain");
        REQUIRE((sample.torque - expected).cwiseAbs().maxCoeff() < 1e-9);
    }
}

TEST_CASE("a delayed torque reading is the past torque") {
    const EffectTrial trial = try_effect("delay", "ur5_torque", seed(), 2000);
    const double delay = trial.parameter("delay");
    CHECK(delay > 0);
    for (std::size_t row = 1000; row < 6000; row += 7) {
        const double then = static_cast<double>(row) - delay * 2000;
        const auto before = static_cast<std::size_t>(then);
        const double share = then - std::floor(then);
        const Eigen::Index joint = trial.joint();
        const double expected = (1 - share) * trial.samples[before].truth.torque[joint] +
                                share * trial.samples[before + 1].truth.torque[joint];
        REQUIRE(trial.samples[row].torque[joint] == Approx(expected).margin(1e-6));
    }
}

TEST_CASE("drifting friction changes by its rate per second relative to the level at the start") {
    const EffectTrial trial = try_effect("friction_drift", "ur5_torque", seed());
    const EffectParameters companion = trial.effect.companion->parameters;
    const bool viscous = companion.front().first == "viscous";
    int compared = 0;
    for (const SimulatedSample& sample : trial.samples) {
        const double velocity = sample.truth.velocity[trial.joint()];
        const double added = (sample.torque - rigid(trial, sample.truth))[trial.joint()];
        const double factor = 1 + trial.parameter("rate") * sample.time_s;
        const bool backward = companion.size() > 1 && velocity < 0; // the second level of Coulomb friction
        const double level = companion[backward ? 1 : 0].second;
        if (viscous) {
            REQUIRE(added == Approx(level * factor * velocity).margin(1e-6));
        } else if (std::abs(velocity) > 0.3) {
            REQUIRE(added == Approx(std::copysign(level * factor, velocity)).epsilon(0.02));
        }
        compared += viscous || std::abs(velocity) > 0.3 ? 1 : 0;
    }
    CHECK(compared > 200);
}

TEST_CASE("a push on a joint is the torque of the surroundings and reduces the actuator's torque") {
    const EffectTrial trial = try_effect("external_contact", "three_joint_torque", seed());
    const double start = trial.parameter("start");
    const double end = trial.parameter("end");
    check_addition(trial, 1e-8, [&](const SimulatedSample& sample) {
        const double along = (sample.truth.time_s - start) / (end - start);
        const double wave = along > 0 && along < 1 ? std::sin(std::numbers::pi * along) : 0;
        return -trial.parameter("peak") * wave * wave;
    });
}

TEST_CASE("backlash lets the link lag behind its motor by half the gap in either direction") {
    const EffectTrial trial = try_effect("backlash", "three_joint_torque", seed());
    const double gap = trial.parameter("gap");
    double ahead = 0;
    double behind = 0;
    for (const SimulatedSample& sample : trial.samples) {
        const double twist = (sample.truth.motor_position - sample.truth.position)[trial.joint()];
        ahead = std::max(ahead, twist);
        behind = std::min(behind, twist);
        REQUIRE(sample.position[trial.joint()] ==
                Approx(sample.truth.motor_position[trial.joint()]).margin(1e-7));
    }
    // The contacts are slightly elastic.
    CHECK(ahead == Approx(gap / 2).epsilon(0.25));
    CHECK(behind == Approx(-gap / 2).epsilon(0.25));
}

TEST_CASE("a soft gear twists by its transmitted torque divided by its stiffness") {
    for (const std::string& robot : robots) {
        EffectTrial trial = try_effect("joint_flexibility", robot, seed());
        trial.effect.hide(trial.size, trial.setup.scenario);
        trial.effect.rebuild(trial.setup.robot); // the links without the rotor
        const double damping = trial.setup.scenario.actuators.gear.damping[trial.joint()];
        double squares = 0;
        double errors = 0;
        for (const SimulatedSample& sample : trial.samples) {
            const SimulatedTruth& truth = sample.truth;
            const double twist = (truth.motor_position - truth.position)[trial.joint()];
            const double rate = (truth.motor_velocity - truth.velocity)[trial.joint()];
            const double torque = rigid(trial, truth)[trial.joint()];
            squares += torque * torque;
            errors += std::pow(trial.parameter("stiffness") * twist + damping * rate - torque, 2);
        }
        CHECK(std::sqrt(errors / squares) < 1e-6);
    }
}

TEST_CASE("backlash and compliance that approach zero leave the nominal arm") {
    EffectTrial trial = try_effect("joint_flexibility", "ur5_torque", seed());
    Scenario scenario = trial.setup.scenario;
    trial.effect.hide(trial.size, scenario);
    // The largest stiffness that the integration step can follow.
    scenario.actuators.gear.stiffness = 4e6 * scenario.actuators.rotor_inertia;
    scenario.actuators.gear.damping = 2e3 * scenario.actuators.rotor_inertia;
    scenario.integration_rate_hz = 8000;
    Robot arm = trial.setup.robot;
    trial.effect.rebuild(arm);
    Simulation simulation(arm, scenario);
    double squares = 0;
    double errors = 0;
    for (int row = 0; row < 1000; ++row) {
        const SimulatedSample sample = simulation.next();
        const JointVector expected = rigid(trial, sample.truth);
        squares += expected.squaredNorm();
        errors += (sample.torque - expected).squaredNorm();
    }
    CHECK(std::sqrt(errors / squares) < 0.01);
}
