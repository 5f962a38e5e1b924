// SPDX-License-Identifier: Apache-2.0
#include "tools/control/closed_loop.hpp"

#include "tools/base/text/error.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

ClosedLoop::Link::Link(const BusDescription& bus, const Scenario& scenario)
    : devices(plant_end, scenario.seed), loop(bus, 1 / scenario.controller.rate_hz),
      plant(bus, scenario.torque_sensor) {
    MemoryBus::join(loop_end, plant_end);
}

ClosedLoop::ClosedLoop(const Robot& robot, const Scenario& scenario, const std::string& source,
                       const LoopModel* learned, const BusDescription* bus, const LoopLimits& limits)
    : period_s_(1 / scenario.controller.rate_hz),
      link_(bus != nullptr ? std::make_unique<Link>(*bus, scenario) : nullptr),
      loop_(
          make_control_loop(robot, scenario, source, learned, link_ ? link_->loop.delay_ticks() : 0, limits)),
      plant_(robot, scenario, loop_->reference().position), faults_(scenario.faults, robot.joints.size()),
      losses_(scenario.seed) {
    if (bus != nullptr) {
        check_bus(*bus, robot, scenario);
    }
}

std::int64_t ClosedLoop::pace_ns(std::int64_t tick) const {
    return std::llround(static_cast<double>(tick) * period_s_ * 1e9);
}

const LinkFaults& ClosedLoop::faults_at(double motion_time_s) {
    static const LinkFaults none;
    if (loop_->state() == LoopState::waiting) {
        return none;
    }
    faults_.go_to(motion_time_s);
    return faults_.now().link;
}

/// Returns the start time of the next tick. A tick never starts before the previous one.
std::int64_t ClosedLoop::begin_ns() {
    begun_ns_ = std::max(begun_ns_, pace_ns(tick_) + faults_at(motion_time(tick_)).late_ns);
    return begun_ns_;
}

/// Runs the next cycle of the devices: one reading of every sensor.
void ClosedLoop::measure() {
    const std::int64_t now_ns = pace_ns(cycle_);
    const double time_s = motion_time(cycle_);
    plant_.advance_to(time_s);
    position_when_due_.push_back(plant_.truth().position);
    const LinkFaults& faults = faults_at(time_s);
    bus_set_ns_ = faults.bus_set_ns;
    if (!link_) {
        readings_ = {now_ns + bus_set_ns_, !faults.devices_silent && !losses_.next(faults.share_lost),
                     plant_.position(), plant_.torque()};
        return;
    }
    link_->loop_end.set_time(now_ns + bus_set_ns_);
    link_->plant_end.set_time(now_ns);
    link_->devices.set_faults(faults);
    if (cycle_ > tick_) { // the loop is late: drives drop a command that is too old
        plant_.apply(link_->plant.torque(now_ns));
    }
    link_->plant.send(link_->devices, plant_);
    link_->loop_end.set_wall_clock(faults.wall_set_ns);
}

LoopInput ClosedLoop::sense(std::int64_t due_ns, std::int64_t now_ns) {
    if (link_) {
        link_->loop_end.set_time(now_ns + bus_set_ns_);
        link_->loop.receive(link_->loop_end, due_ns + bus_set_ns_);
        return link_->loop.sense(now_ns + bus_set_ns_);
    }
    LoopInput input;
    input.time_ns = readings_.fresh ? readings_.time_ns : due_ns + bus_set_ns_;
    input.position = readings_.fresh ? &readings_.position : nullptr;
    input.torque = readings_.fresh ? &readings_.torque : nullptr;
    readings_.fresh = false;
    return input;
}

void ClosedLoop::command(std::int64_t now_ns, const JointVector& torque) {
    const LinkFaults& faults = faults_at(plant_.time_s());
    if (!link_) {
        if (!losses_.next(faults.share_lost)) {
            plant_.apply(torque);
        }
        return;
    }
    link_->plant_end.set_time(now_ns);
    link_->devices.set_faults(faults);
    link_->loop.send(link_->loop_end, torque);
    link_->plant.receive(link_->devices);
    plant_.apply(link_->plant.torque(now_ns));
}

void ClosedLoop::note_reaction(double time_s) {
    faults_.go_to(time_s);
    const ArmFaults& arm = faults_.now().arm;
    const bool pushed = !arm.pushes.empty() || !arm.load.isZero(0);
    if (pushed && !pushed_) {
        push_s_ = time_s;
        answered_ = false;
    }
    pushed_ = pushed;
    for (; known_actions_ < loop_->actions().size(); ++known_actions_) {
        const bool contact = loop_->actions()[known_actions_].cause == Cause::contact;
        const double after_s = time_s + period_s_ - push_s_; // the next command is the first one of it
        if (contact && !answered_ && after_s <= longest_reaction_s) {
            reactions_.push_back({push_s_, after_s});
            answered_ = true;
        }
    }
}

void ClosedLoop::run_to(double time_s, const std::function<void(const ClosedLoopInstant&)>& on_tick) {
    while (motion_time(tick_) < time_s && loop_->state() != LoopState::stopped) {
        ClosedLoopInstant instant;
        instant.time_s = motion_time(tick_);
        const std::int64_t due_ns = pace_ns(tick_);
        const std::int64_t now_ns = begin_ns();
        while (pace_ns(cycle_) <= now_ns) {
            measure();
            ++cycle_;
        }
        plant_.advance_to(instant.time_s + 1e-9 * static_cast<double>(now_ns - due_ns));
        instant.measured = sense(due_ns, now_ns);
        instant.measured.deadline_missed = static_cast<double>(now_ns - due_ns) > 1e9 * period_s_;
        instant.command = loop_->tick(instant.measured);
        ++tick_;
        instant.error = loop_->reference().position - position_when_due_.front();
        position_when_due_.pop_front();
        if (loop_->state() == LoopState::waiting) {
            ++waited_;
            check_waiting();
            continue;
        }
        note_reaction(instant.time_s);
        on_tick(instant);
        command(now_ns, instant.command);
    }
}

void ClosedLoop::check_waiting() const {
    constexpr double longest_s = 30;
    if (static_cast<double>(tick_) * period_s_ > longest_s) {
        throw InputError("expected valid positions of all joints within 30 s, found none");
    }
}

} // namespace dfdyn::tools
