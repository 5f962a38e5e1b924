// SPDX-License-Identifier: Apache-2.0
#include "tests/loop_panel/strangers_loop.hpp"

#include "dfdyn/control/loop_margin.hpp"
#include "tests/diagnosis/panel/effects/panel_effect.hpp"
#include "tests/diagnosis/panel/recording/panel_setup.hpp"
#include "tests/loop_panel/loop_trial.hpp"
#include "tools/base/text/error.hpp"

#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace dfdyn::tests {

using namespace tools;

namespace {

constexpr double whole_turn = 2 * std::numbers::pi;
constexpr double studied_s = 20, step_s = 0.05;
constexpr double gravity = 9.81;
constexpr double largest_error = 0.15; // of a link's mass, relative

/// What a motion asks of the arm's joints.
struct Demand {
    JointVector torque;       ///< largest, N·m, of the rigid body
    JointVector least, usual; ///< inertia: smallest with the other joints free, mean with them locked
};

Demand demand_of(const Robot& robot, const Scenario& scenario) {
    const ArmDynamics dynamics(robot, scenario.actuators.rotor_inertia);
    const std::unique_ptr<Task> task = make_task(scenario.task, robot, step_s, scenario.seed);
    ArmDynamics::Configuration configuration;
    Demand demand;
    const int steps = static_cast<int>(studied_s / step_s);
    for (int step = 0; step < steps; ++step) {
        const tools::Reference reference = task->next();
        dynamics.configure(reference.position, configuration);
        const JointMatrix mass = dynamics.mass_matrix(configuration);
        const JointVector torque =
            dynamics.inverse(configuration, reference.velocity, reference.acceleration).cwiseAbs();
        const JointVector free = mass.inverse().diagonal().cwiseInverse();
        if (step == 0) {
            demand = {torque, free, JointVector::Zero(torque.size())};
        }
        demand.torque = demand.torque.cwiseMax(torque);
        demand.least = demand.least.cwiseMin(free);
        demand.usual += mass.diagonal() / steps;
    }
    return demand;
}

/// Rotors of geared motors: of the size of the links that they move.
JointVector random_rotors(const Robot& robot, const Scenario& scenario, Draw& draw) {
    Scenario bare = scenario;
    bare.actuators.rotor_inertia = JointVector::Zero(static_cast<Eigen::Index>(robot.joints.size()));
    JointVector rotors = demand_of(robot, bare).usual;
    const double share = draw.log_uniform(0.1, 1.5);
    const double base = rotors[0];
    for (Eigen::Index joint = 0; joint < rotors.size(); ++joint) {
        const double floor =
            base * std::pow(0.35, static_cast<double>(joint)); // motors become smaller slowly
        rotors[joint] = share * draw.log_uniform(0.6, 1.6) * std::max(rotors[joint], 0.1 * floor);
    }
    return rotors;
}

void add_friction(ActuatorModel& actuators, const Demand& demand, double integration_rate_hz, Draw& draw) {
    const double share = draw.log_uniform(0.02, 0.1);
    const double bend = draw.log_uniform(3e-4, 3e-3); // rad of the bristles at the level of friction
    for (Eigen::Index joint = 0; joint < demand.torque.size(); ++joint) {
        const double inertia = demand.least[joint];
        LuGreParameters friction;
        friction.coulomb = share * draw.log_uniform(0.6, 1.6) * (*actuators.torque_limit)[joint];
        friction.breakaway = friction.coulomb * draw.uniform(1, 1.5);
        friction.stribeck_velocity = draw.log_uniform(0.02, 0.15);
        friction.viscous = friction.coulomb * draw.log_uniform(0.1, 1);
        add_bristles(friction, friction.coulomb, bend, inertia, 0.7 * integration_rate_hz);
        friction.damping = std::min(draw.uniform(0.2, 0.8) * std::sqrt(friction.stiffness * inertia),
                                    0.5 * integration_rate_hz * inertia);
        actuators.friction.push_back(friction);
    }
}

nlohmann::json bus_with(const nlohmann::json& joints, const std::string& trigger, double rate_hz) {
    return {{"schema", "dfdyn.bus/1"},   {"bit_rate", 1000000},
            {"sample_rate_hz", rate_hz}, {"trigger", {{"on", trigger}}},
            {"joints", joints},          {"output", {{"family", "efforts"}, {"quantity", "tau"}}}};
}

nlohmann::json moteus_bus(int joints, double rate_hz) {
    nlohmann::json boards = nlohmann::json::array();
    for (int joint = 1; joint <= joints; ++joint) {
        boards.push_back({{"id", joint}, {"joint", joint}});
    }
    nlohmann::json bus = bus_with({{"family", "moteus"}, {"boards", boards}}, "timer", rate_hz);
    bus["data_bit_rate"] = 5000000;
    return bus;
}

nlohmann::json drives_bus(const JointVector& torque_limit, double rate_hz, int bits) {
    nlohmann::json boards = nlohmann::json::array();
    for (Eigen::Index joint = 0; joint < torque_limit.size(); ++joint) {
        boards.push_back({{"node", joint + 1},
                          {"joint", joint + 1},
                          {"counts_per_turn", 1 << bits},
                          {"effort_per_count", torque_limit[joint] / 3000}});
    }
    return bus_with({{"family", "cia402"},
                     {"position", {{"pdo", "0x280"}, {"length", 6}, {"start_bit", 0}, {"bits", 32}}},
                     {"effort", {{"pdo", "0x280"}, {"length", 6}, {"start_bit", 32}, {"bits", 16}}},
                     {"boards", boards}},
                    "sync", rate_hz);
}

/// Connects the loop by moteus controllers, by CiA 402 drives, or directly. A bus that is too slow is left
/// out.
void add_bus(StrangersLoop& loop, Draw& draw) {
    const double kind = draw.uniform(0, 1);
    const double rate_hz = loop.scenario.controller.rate_hz;
    if (kind < 0.3) {
        return;
    }
    loop.bus =
        kind < 0.65
            ? parse_bus_description(moteus_bus(static_cast<int>(loop.robot.joints.size()), rate_hz), "moteus")
            : parse_bus_description(drives_bus(*loop.scenario.actuators.torque_limit, rate_hz,
                                               loop.scenario.encoders.bits_per_turn),
                                    "cia402");
    try {
        check_bus(*loop.bus, loop.robot, loop.scenario);
    } catch (const InputError&) {
        loop.bus.reset();
    }
}

/// Size of the encoders' count, rad.
double count_of(const Scenario& scenario) { return whole_turn / std::exp2(scenario.encoders.bits_per_turn); }

void add_sensors(Scenario& scenario, Draw& draw) {
    const double rate_hz = scenario.controller.rate_hz;
    scenario.encoders.rate_hz = scenario.derivatives.rate_hz = rate_hz;
    scenario.encoders.bits_per_turn = draw.whole(13, 20);
    const double count = count_of(scenario);
    scenario.encoders.noise = draw.chance(0.5) ? 0 : count * draw.uniform(0.1, 0.8);
    scenario.encoders.eccentricity = scenario.encoders.eccentricity_phase =
        JointVector::Zero(scenario.actuators.torque_limit->size());
    scenario.derivatives.noise_bound = draw.chance(0.3) ? 0 : count * draw.log_uniform(1, 8);
    const double window_s = draw.log_uniform(0.004, 0.03);
    scenario.derivatives.velocity_window = std::max(2, static_cast<int>(std::lround(window_s * rate_hz)));
    scenario.torque_sensor.noise = *scenario.actuators.torque_limit * draw.log_uniform(0.002, 0.02);
}

/// What the description of the arm does not say.
void add_errors(StrangersLoop& loop, double torque, Draw& draw) {
    Scenario& scenario = loop.scenario;
    for (std::size_t joint = 0; joint < loop.robot.joints.size(); ++joint) {
        const double mass = loop.robot.joints[joint].inertia[0];
        scenario.robot_errors.links.push_back({joint, mass * draw.uniform(-largest_error, largest_error)});
    }
    if (draw.chance(0.6)) {
        const double mass = draw.uniform(0.02, 0.15) * torque / (gravity * reach_of(loop.robot));
        scenario.payloads = {{0, mass, Eigen::Vector3d::Zero()}};
    }
    scenario.actuators.bandwidth_hz = draw.chance(0.5) ? 0 : draw.log_uniform(150, 1000);
}

/// The arm as it is, with its payload.
Robot loaded(const StrangersLoop& loop) {
    Robot robot = real_robot(loop.robot, loop.scenario.robot_errors);
    for (const Payload& payload : loop.scenario.payloads) {
        robot.joints.back().inertia +=
            body_parameters(payload.mass, robot.tip_placement.translation(), Eigen::Matrix3d::Zero());
    }
    return robot;
}

/// Elastic gears on which links with these inertias (kg·m²) vibrate at `hz` while the motors are held.
GearModel elastic_gears(const JointVector& links, double hz) {
    constexpr int most_coordinates = 12;
    constexpr double damping_ratio = 0.03;
    const Eigen::Index joints = links.size();
    const JointVector rigid = JointVector::Zero(joints);
    GearModel gear{rigid, rigid, rigid};
    const double rate = whole_turn * hz;
    for (Eigen::Index joint = 0; joint < std::min(joints, most_coordinates - joints); ++joint) {
        gear.stiffness[joint] = links[joint] * rate * rate;
        gear.damping[joint] = 2 * damping_ratio * links[joint] * rate;
    }
    return gear;
}

/// What an engineer wants of the feedback.
struct Wish {
    double margin;    ///< phase margin, rad
    double damping;   ///< ratio
    double bandwidth; ///< rad/s
};

/// Adds gains with the wished damping and the largest bandwidth, up to the wished one, that keeps the margin.
/// They move a stuck joint before its error is 0.05 rad.
void add_gains(StrangersLoop& loop, const Demand& demand, const Wish& wish) {
    constexpr double largest_stuck_rad = 0.05, least_bandwidth = 1;
    ControllerModel& controller = loop.scenario.controller;
    const DerivativeModel& filter = loop.scenario.derivatives;
    const double delay_s = (loop.bus ? 3.5 : 1.5) / controller.rate_hz;
    const double filter_s = filter.velocity_window / filter.rate_hz / 2;
    controller.position_gain = controller.velocity_gain = demand.usual;
    for (Eigen::Index joint = 0; joint < demand.usual.size(); ++joint) {
        const double inertia = demand.usual[joint];
        const double friction = loop.scenario.actuators.friction[static_cast<std::size_t>(joint)].breakaway;
        double bandwidth = std::max(wish.bandwidth, std::sqrt(friction / (largest_stuck_rad * inertia)));
        for (bool enough = false; !enough; bandwidth *= 0.9) {
            const double stiffness = inertia * bandwidth * bandwidth;
            const double damping = 2 * wish.damping * inertia * bandwidth;
            controller.position_gain[joint] = stiffness;
            controller.velocity_gain[joint] = damping;
            const JointLoop<double> feedback{demand.least[joint], stiffness, damping, delay_s, filter_s};
            enough = bandwidth < least_bandwidth || LoopMargin(feedback, 0.0).phase(0) > wish.margin;
        }
    }
}

/// Changes gains and filter until the engineer is content. Returns whether that succeeds.
bool tune(StrangersLoop& loop, const Demand& demand, Draw& draw) {
    constexpr int most_attempts = 12;
    constexpr double commissioning_s = 12, largest_step = 0.05, longest_window_s = 0.02;
    Wish wish{draw.uniform(30, 50) * std::numbers::pi / 180, draw.uniform(0.6, 1.1), draw.log_uniform(6, 40)};
    DerivativeModel& filter = loop.scenario.derivatives;
    for (int attempt = 0; attempt < most_attempts; ++attempt) {
        add_gains(loop, demand, wish);
        const LoopTrial trial = run_loop(loop, false, nullptr, commissioning_s);
        if (!trial.stop.empty()) { // too soft
            wish.bandwidth *= 1.1;
            wish.margin *= 0.97;
        } else if (trial.step <= largest_step) {
            return true;
        } else if (filter.velocity_window < longest_window_s * filter.rate_hz) { // rattles
            filter.velocity_window = 1 + filter.velocity_window * 5 / 4;
            filter.noise_bound = std::max(1.5 * count_of(loop.scenario), 1.2 * filter.noise_bound);
        } else {
            wish.bandwidth *= 0.85;
        }
    }
    return false;
}

} // namespace

std::string StrangersLoop::summary() const {
    char text[96];
    std::snprintf(text, sizeof text, "%zu joints, %.0f N·m, %.0f Hz, %s, %d bits", robot.joints.size(),
                  scenario.actuators.torque_limit->maxCoeff(), scenario.controller.rate_hz,
                  bus ? bus->source.c_str() : "direct", scenario.encoders.bits_per_turn);
    return text;
}

std::optional<StrangersLoop> draw_strangers_loop(std::uint64_t seed, double gear_hz) {
    const UnknownArm arm = draw_unknown_arm(seed);
    Draw draw(seed, 5);
    StrangersLoop loop;
    loop.robot = arm.robot;
    loop.robot.sensor.reset();
    Scenario& scenario = loop.scenario;
    scenario.seed = seed;
    scenario.controller.kind = ControllerKind::feed_forward;
    scenario.controller.rate_hz = draw.of<double>({125, 250, 500, 500, 1000, 1000});
    scenario.task = random_task(arm.kind, loop.robot, studied_s, draw);
    scenario.actuators.rotor_inertia = random_rotors(loop.robot, scenario, draw);
    const Demand demand = demand_of(loop.robot, scenario);
    add_errors(loop, demand.torque.maxCoeff(), draw);
    const JointVector torque = demand_of(loaded(loop), scenario).torque * draw.uniform(2, 5);
    // a joint that carries nothing has a motor for its own inertia
    scenario.actuators.torque_limit = torque.cwiseMax(demand.usual * draw.log_uniform(15, 60));
    if (gear_hz > 0) {
        scenario.actuators.gear = elastic_gears(demand.usual - scenario.actuators.rotor_inertia, gear_hz);
    }
    add_friction(scenario.actuators, demand, scenario.integration_rate_hz, draw);
    add_sensors(scenario, draw);
    add_bus(loop, draw);
    return tune(loop, demand, draw) ? std::optional(loop) : std::nullopt;
}

} // namespace dfdyn::tests
