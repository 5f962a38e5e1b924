// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop_setup.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/can/arm/bus_wire.hpp"
#include "tools/can/arm/device_frames.hpp"
#include "tools/can/arm/torque_frames.hpp"
#include "tools/control/observer_bandwidth.hpp"
#include "tools/simulation/arm/joint_limits.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace dfdyn::tools {

namespace {

constexpr double ramp_s = 0.2;

JointVector torque_limit(const Robot& robot, const Scenario& scenario, const std::string& source) {
    if (scenario.actuators.torque_limit) {
        return *scenario.actuators.torque_limit;
    }
    JointVector limit(static_cast<Eigen::Index>(robot.joints.size()));
    for (Eigen::Index i = 0; i < limit.size(); ++i) {
        const RobotJoint& joint = robot.joints[static_cast<std::size_t>(i)];
        if (!joint.effort) {
            throw InputError(source + ": actuators.torque_limit_nm: expected a limit of joint " + joint.name +
                             ", for which the robot has none, found none");
        }
        limit[i] = *joint.effort;
    }
    return limit;
}

/// Returns one value per joint from `given`, which has one value or one per joint.
JointVector per_joint(const std::vector<double>& given, const Robot& robot, const std::string& option) {
    const std::size_t joints = robot.joints.size();
    if (given.size() != 1 && given.size() != joints) {
        throw InputError(option + ": expected 1 value, or one for each of " + std::to_string(joints) +
                         " joints, found " + std::to_string(given.size()));
    }
    JointVector result(static_cast<Eigen::Index>(joints));
    for (std::size_t i = 0; i < joints; ++i) {
        result[static_cast<Eigen::Index>(i)] = given[given.size() == 1 ? 0 : i];
    }
    return result;
}

int knot_ticks(double period_s, double knot_s, const std::string& source) {
    const double ratio = knot_s / period_s;
    if (!(ratio >= 1 && std::abs(ratio - std::round(ratio)) < 1e-3)) {
        throw InputError(source + ": expected a sample period that is a multiple of the loop's " +
                         number_text(period_s) + " s, found " + number_text(knot_s) + " s");
    }
    return static_cast<int>(std::lround(ratio));
}

/// Worst-case share of the bit rate for the devices' frames and the commands to them.
double bus_load(const BusDescription& bus) {
    BusDescription joints = bus;
    joints.sensor.reset();
    const std::vector<double> values(static_cast<std::size_t>(bus.joint_count));
    const DeviceFrames devices(joints);
    std::vector<hal::Frame> frames = devices.joints(values, values);
    TorqueFrames commands(bus);
    std::ranges::copy(commands.encode(values), std::back_inserter(frames));
    if (const std::optional<hal::Frame> sync = devices.sync()) {
        frames.push_back(*sync);
    }
    double bits = 0;
    for (const hal::Frame& frame : frames) {
        bits += frame_bits(frame, bus.data_rate_ratio()) * bus.joints.rate_hz;
    }
    hal::Frame longest;
    longest.length = 8;
    // a wrench consists of two frames
    bits += bus.sensor ? 2 * frame_bits(longest) * bus.output.rate_hz : 0;
    return bits / bus.bit_rate;
}

} // namespace

SafeStopConfig default_limits(const Robot& robot, const Scenario& scenario, const JointVector& torque_limit,
                              const JointVector& start) {
    constexpr double following_share = 0.8, largest_angle_rad = 0.5, largest_way_m = 0.1;
    constexpr double sticking_share = 0.25; // friction in both directions
    constexpr double acceleration_margin = 2, largest_speed = 100;
    constexpr double pressing_s = 0.25, brake_s = 0.2;
    const ControllerModel& controller = scenario.controller;
    const ArmDynamics dynamics(robot, scenario.actuators.rotor_inertia);
    ArmDynamics::Configuration configuration;
    dynamics.configure(start, configuration);
    const JointVector inertia = dynamics.mass_matrix(configuration).diagonal();
    SafeStopConfig config;
    config.torque_limit = torque_limit;
    config.acceleration = acceleration_margin * torque_limit.cwiseQuotient(inertia);
    config.following_error = config.sticking = config.speed_limit = JointVector(torque_limit.size());
    for (Eigen::Index i = 0; i < torque_limit.size(); ++i) {
        const RobotJoint& joint = robot.joints[static_cast<std::size_t>(i)];
        const double gain = controller.position_gain[i];
        const double largest = joint.prismatic ? largest_way_m : largest_angle_rad;
        const double speed = joint.velocity.value_or(0);
        config.following_error[i] =
            gain > 0 ? std::min(largest, following_share * torque_limit[i] / gain) : largest;
        config.sticking[i] =
            gain > 0 ? sticking_share * torque_limit[i] / gain : std::numeric_limits<double>::infinity();
        config.speed_limit[i] =
            speed > 0 && speed <= largest_speed ? speed : std::numeric_limits<double>::infinity();
    }
    const auto ticks = [&](double time_s) {
        return static_cast<int>(std::ceil(time_s * controller.rate_hz));
    };
    config.ramp_ticks = ticks(ramp_s);
    config.pressing_ticks = ticks(pressing_s);
    config.brake_ticks = ticks(brake_s);
    return config;
}

namespace {

JointVector given_bandwidth(const std::vector<double>& given, const Robot& robot, double rate_hz) {
    constexpr double largest_share = 0.2; // of the loop's rate
    JointVector bandwidth = per_joint(given, robot, "--observer-bandwidth");
    if (bandwidth.maxCoeff() > largest_share * rate_hz) {
        throw InputError("--observer-bandwidth: expected at most " + number_text(largest_share * rate_hz) +
                         " rad/s for a loop of " + number_text(rate_hz) + " Hz, found " +
                         number_text(bandwidth.maxCoeff()));
    }
    return bandwidth;
}

void require_feed_forward(ControllerKind kind, const std::string& source) {
    if (kind != ControllerKind::feed_forward) {
        throw InputError(
            source + ": controller.kind: expected feed_forward, found " +
            (kind == ControllerKind::computed_torque ? "computed_torque" : "gravity_compensation"));
    }
}

LoopConfig loop_config(const Robot& robot, const Scenario& scenario, const std::string& source,
                       const JointVector& start, int delay_ticks, const LoopLimits& limits) {
    const ControllerModel& controller = scenario.controller;
    LoopConfig config;
    config.period_s = 1 / controller.rate_hz;
    config.delay_ticks = delay_ticks;
    config.gains = {controller.position_gain, controller.velocity_gain};
    config.filter = loop_filter(scenario);
    config.torque_limit = torque_limit(robot, scenario, source);
    config.safe_stop = default_limits(robot, scenario, config.torque_limit, start);
    config.bandwidth = limits.observer_bandwidth.empty()
                           ? default_bandwidth(robot, scenario, delay_ticks)
                           : given_bandwidth(limits.observer_bandwidth, robot, controller.rate_hz);
    config.safe_stop.mode = limits.mode;
    config.actions = limits.actions;
    config.on_contact = limits.on_contact;
    if (!limits.following_error.empty()) {
        config.safe_stop.following_error = per_joint(limits.following_error, robot, "--following-error");
    }
    if (!limits.speed.empty()) {
        config.safe_stop.speed_limit = per_joint(limits.speed, robot, "--speed-limit");
    }
    return config;
}

/// Returns the learned part of the feed-forward, in the state that an earlier run learned, if any.
LearnedFeedForward learned_part(const Robot& robot, const LoopModel& learned, int knot_ticks,
                                const LoopLimits& limits) {
    const MonitorSetup monitor = monitor_setup(learned.model, &robot, learned.source);
    std::optional<ContactSetup> contact;
    if (limits.on_contact != FindingAction::report) {
        contact = ContactSetup{contact_limits(learned.model, limits.contact_rate_per_hour, learned.source),
                               limits.contact_calibration_s,
                               limits.contact_rate_per_hour.value_or(contact_rate_per_hour)};
    }
    LearnedFeedForward model(learned.model, learned.from_prior, static_cast<int>(robot.joints.size()),
                             knot_ticks, learned.source, &monitor, contact ? &*contact : nullptr);
    if (!learned.learned.empty() && !model.restore(learned.learned)) {
        throw InputError(learned.learned_source + ": expected what " + learned.source +
                         " has learned, whole, found something else");
    }
    return model;
}

/// Throws InputError if the motion exceeds the joints' position limits within its first 20 s.
void check_motion(const Robot& robot, const Scenario& scenario, const std::string& source) {
    constexpr double checked_s = 20;
    const double rate_hz = scenario.controller.rate_hz;
    const std::unique_ptr<Task> task = make_task(scenario.task, robot, 1 / rate_hz, scenario.seed);
    for (int tick = 0; tick <= checked_s * rate_hz; ++tick) {
        check_limits(robot, task->next().position, source + ": task: reference of ");
    }
}

} // namespace

std::unique_ptr<ControlLoop> make_control_loop(const Robot& robot, const Scenario& scenario,
                                               const std::string& source, const LoopModel* learned,
                                               int delay_ticks, const LoopLimits& limits) {
    require_feed_forward(scenario.controller.kind, source);
    check_motion(robot, scenario, source);
    const auto make = [&] {
        return make_task(scenario.task, robot, 1 / scenario.controller.rate_hz, scenario.seed);
    };
    LoopConfig config = loop_config(robot, scenario, source, make()->next().position, delay_ticks, limits);
    std::optional<LearnedFeedForward> model;
    if (learned != nullptr) {
        check_loop_model(learned->model, static_cast<int>(robot.joints.size()), learned->source);
        config.knot_ticks = knot_ticks(config.period_s, learned->model.sample_period_s, learned->source);
        model.emplace(learned_part(robot, *learned, config.knot_ticks, limits));
    }
    JointVector learned_limit = config.torque_limit / 2;
    if (!limits.learned_limit.empty()) {
        learned_limit =
            per_joint(limits.learned_limit, robot, "--learned-limit").cwiseProduct(config.torque_limit);
    }
    FeedForward feed_forward(robot, scenario.actuators.rotor_inertia, std::move(model), config.period_s,
                             config.knot_ticks, config.torque_limit, learned_limit, config.bandwidth,
                             ControlLoop::observer_share * config.torque_limit);
    std::unique_ptr<Task> task = make();
    return std::make_unique<ControlLoop>(std::move(config), std::move(feed_forward), std::move(task));
}

void check_bus(const BusDescription& bus, const Robot& robot, const Scenario& scenario) {
    if (bus.joint_count != static_cast<int>(robot.joints.size())) {
        throw InputError(bus.source + ": joints: expected the robot's " +
                         std::to_string(robot.joints.size()) + " joints, found " +
                         std::to_string(bus.joint_count));
    }
    if (std::abs(bus.joints.rate_hz - scenario.controller.rate_hz) > 1e-6 * bus.joints.rate_hz) {
        throw InputError(bus.source + ": joints: expected the rate of the loop, " +
                         number_text(scenario.controller.rate_hz) + " Hz, found " +
                         number_text(bus.joints.rate_hz));
    }
    if (const double load = bus_load(bus); load > 1) {
        throw InputError(bus.source +
                         ": bit_rate: expected a bus that carries its devices' frames and their "
                         "commands, found one that they load to " +
                         std::to_string(std::lround(100 * load)) + " %");
    }
    if (bus.sensor && !scenario.force_torque) {
        throw InputError(bus.source + ": output: expected a scenario with force_torque for this sensor, "
                                      "found one without");
    }
    const bool currents = bus.outputs == OutputKind::motor_current;
    if (currents && std::ranges::any_of(
                        bus.boards, [](const BusBoard& board) { return board.board->commands_efforts(); })) {
        throw InputError(bus.source +
                         ": output.quantity: expected tau, with effort_per_count in N·m, because "
                         "the torque command of these drives has the unit of their efforts, "
                         "found i");
    }
    if (currents && !scenario.torque_sensor.torque_constant) {
        throw InputError(bus.source + ": output.quantity: expected a scenario with "
                                      "actuators.torque_constant_nm_per_a for currents, found one without");
    }
}

} // namespace dfdyn::tools
