// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop_port.hpp"

#include <cmath>

namespace dfdyn::tools {

namespace {

int delay_of(const BusDescription& description, double loop_period_s) {
    switch (description.trigger) {
    case BusTrigger::sync: // a sample is complete at the SYNC after its own
        return static_cast<int>(std::lround(1 / (description.joints.rate_hz * loop_period_s)));
    case BusTrigger::timer:
        return static_cast<int>(
            std::lround(static_cast<double>(description.delay_ns) * 1e-9 / loop_period_s));
    case BusTrigger::set:
        break;
    }
    return 0;
}

} // namespace

LoopPort::LoopPort(const BusDescription& description, double loop_period_s)
    : timer_(description.trigger == BusTrigger::timer),
      measures_torque_(description.outputs == OutputKind::joint_torque),
      delay_ticks_(delay_of(description, loop_period_s)), period_ns_(std::llround(loop_period_s * 1e9)),
      arm_(make_bus_arm(description)), commands_(description), position_(description.joint_count),
      torque_(description.joint_count) {}

LoopInput LoopPort::sense(std::int64_t tick_ns, std::int64_t now_ns) {
    LoopInput input;
    input.time_ns = tick_ns - delay_ticks_ * period_ns_;
    input.bus_lost = bus_lost_;
    const std::optional<std::int64_t> instant = timer_ ? std::optional(input.time_ns) : moment_;
    if (!instant) {
        return input;
    }
    const BusSample& sample = arm_->assemble(*instant, now_ns);
    if (!sample.valid()) {
        return input;
    }
    position_ = Eigen::Map<const Eigen::VectorXd>(sample.position.data(), position_.size());
    input.time_ns = *instant;
    input.position = &position_;
    if (measures_torque_ && sample.output_valid()) {
        torque_ = Eigen::Map<const Eigen::VectorXd>(sample.output.data(), torque_.size());
        input.torque = &torque_;
    } else if (!measures_torque_ && command_.size() > 0) {
        input.torque = &command_;
    }
    return input;
}

} // namespace dfdyn::tools
