// SPDX-License-Identifier: Apache-2.0
#include "tools/control/bus/plant_port.hpp"

#include <limits>
#include <utility>

namespace dfdyn::tools {

PlantPort::PlantPort(const BusDescription& description, TorqueSensorModel torque_sensor)
    : devices_(description), torques_(description), has_sensor_(description.sensor.has_value()),
      currents_(description.outputs == OutputKind::motor_current), torque_sensor_(std::move(torque_sensor)),
      torque_(JointVector::Zero(description.joint_count)),
      next_heartbeat_ns_(std::numeric_limits<std::int64_t>::min()) {}

void PlantPort::take(const hal::Frame& frame, std::int64_t now_ns) {
    if (torques_.take(frame, {torque_.data(), static_cast<std::size_t>(torque_.size())})) {
        ++commands_;
        commanded_ns_ = now_ns;
        driven_ = true;
    }
}

const JointVector& PlantPort::torque(std::int64_t now_ns) {
    if (driven_ && now_ns - commanded_ns_ > command_timeout_ns) {
        driven_ = false;
        ++timeouts_;
        torque_.setZero();
    }
    return torque_;
}

} // namespace dfdyn::tools
