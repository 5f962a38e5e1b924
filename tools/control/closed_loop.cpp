// SPDX-License-Identifier: Apache-2.0
#include "tools/control/closed_loop.hpp"

#include "tools/common/error.hpp"

#include <cmath>

namespace dfdyn::tools {

ClosedLoop::Link::Link(const BusDescription& bus, const Scenario& scenario)
    : loop(bus, 1 / scenario.controller.rate_hz), plant(bus, scenario.torque_sensor) {
    MemoryBus::join(loop_end, plant_end);
}

ClosedLoop::ClosedLoop(const Robot& robot, const Scenario& scenario, const std::string& source,
                       const LoopModel* learned, const BusDescription* bus)
    : period_s_(1 / scenario.controller.rate_hz),
      link_(bus != nullptr ? std::make_unique<Link>(*bus, scenario) : nullptr),
      loop_(make_control_loop(robot, scenario, source, learned, link_ ? link_->loop.delay_ticks() : 0)),
      plant_(robot, scenario, loop_->reference().position) {
    if (bus != nullptr) {
        check_bus(*bus, robot, scenario);
    }
}

LoopInput ClosedLoop::sense(std::int64_t time_ns) {
    if (link_) {
        link_->loop_end.set_time(time_ns);
        link_->plant_end.set_time(time_ns);
        link_->plant.send(link_->plant_end, plant_);
        link_->loop.receive(link_->loop_end);
        return link_->loop.sense(time_ns, time_ns);
    }
    position_ = plant_.position();
    torque_ = plant_.torque();
    LoopInput input;
    input.time_ns = time_ns;
    input.position = &position_;
    input.torque = &torque_;
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
    while (static_cast<double>(moving_tick_) * period_s_ < time_s && loop_->state() != LoopState::stopped) {
        ClosedLoopInstant instant;
        instant.time_s = static_cast<double>(moving_tick_) * period_s_;
        plant_.advance_to(instant.time_s);
        const std::int64_t time_ns = std::llround(static_cast<double>(tick_++) * period_s_ * 1e9);
        instant.measured = sense(time_ns);
        instant.command = loop_->tick(instant.measured);
        if (loop_->state() == LoopState::waiting) {
            check_waiting();
            continue;
        }
        ++moving_tick_;
        instant.error = loop_->reference().position - plant_.truth().position;
        on_tick(instant);
        command(time_ns, instant.command);
    }
}

void ClosedLoop::check_waiting() const {
    constexpr double longest_s = 30;
    if (static_cast<double>(tick_) * period_s_ > longest_s) {
        throw InputError("expected positions of all joints, found none that can be believed for 30 s");
    }
}

} // namespace dfdyn::tools
