// SPDX-License-Identifier: Apache-2.0
#include "tools/control/closed_loop.hpp"

#include "tools/common/error.hpp"
#include "tools/common/number.hpp"

#include <cmath>

namespace dfdyn::tools {

ClosedLoop::Link::Link(const BusDescription& bus, double period_s) : loop(bus, period_s), plant(bus) {
    MemoryBus::join(loop_end, plant_end);
}

ClosedLoop::ClosedLoop(const Robot& robot, const Scenario& scenario, const std::string& source,
                       const LoopModel* learned, const BusDescription* bus)
    : period_s_(1 / scenario.controller.rate_hz),
      link_(bus != nullptr ? std::make_unique<Link>(*bus, period_s_) : nullptr),
      loop_(make_control_loop(robot, scenario, source, learned, link_ ? link_->loop.delay_ticks() : 0)),
      plant_(robot, scenario, loop_->reference().position) {
    if (bus != nullptr) {
        check_bus(*bus, robot, scenario);
    }
}

LoopInput ClosedLoop::sense(std::int64_t time_ns, ClosedLoopInstant& instant) {
    if (link_) {
        link_->loop_end.set_time(time_ns);
        link_->plant_end.set_time(time_ns);
        link_->plant.send(link_->plant_end, plant_);
        link_->loop.receive(link_->loop_end);
        return link_->loop.sense(time_ns, time_ns);
    }
    instant.position = plant_.position();
    instant.torque = plant_.torque();
    LoopInput input;
    input.time_ns = time_ns;
    input.position = &instant.position;
    input.torque = &instant.torque;
    return input;
}

void ClosedLoop::command(std::int64_t time_ns, const JointVector& torque) {
    if (!link_) {
        plant_.apply(torque);
        return;
    }
    link_->loop.send(link_->loop_end, torque);
    link_->plant.receive(link_->plant_end);
    plant_.apply(link_->plant.torque(time_ns));
}

void ClosedLoop::run_to(double time_s, const std::function<void(const ClosedLoopInstant&)>& on_tick) {
    while (static_cast<double>(moving_tick_) * period_s_ < time_s) {
        ClosedLoopInstant instant;
        instant.time_s = static_cast<double>(moving_tick_) * period_s_;
        plant_.advance_to(instant.time_s);
        const std::int64_t time_ns = std::llround(static_cast<double>(tick_++) * period_s_ * 1e9);
        const LoopInput input = sense(time_ns, instant);
        instant.position = input.position != nullptr ? *input.position : JointVector();
        instant.torque = input.torque != nullptr ? *input.torque : JointVector();
        instant.command = loop_->tick(input);
        if (loop_->state() == LoopState::waiting) {
            check_waiting();
            continue;
        }
        ++moving_tick_;
        instant.error = loop_->reference().position - plant_.truth().position;
        command(time_ns, instant.command);
        on_tick(instant);
    }
}

void ClosedLoop::check_waiting() const {
    constexpr double longest_s = 10;
    if (static_cast<double>(tick_) * period_s_ > longest_s) {
        throw InputError("expected positions of all joints, found none that can be believed for 10 s");
    }
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
    if (bus.sensor && !scenario.force_torque) {
        throw InputError(bus.source + ": output: expected a scenario with force_torque for this sensor, "
                                      "found one without");
    }
}

} // namespace dfdyn::tools
