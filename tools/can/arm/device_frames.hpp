// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/description/bus_description.hpp"

#include <optional>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// Frames that the devices of a bus description send, with their quantisation and saturation. For simulated
/// devices, and for a recording that is replayed on a bus. The frames have no time stamps; the caller stamps
/// them.
class DeviceFrames {
  public:
    /// Throws InputError if the description lacks the full scale or calibration of a sensor, without which it
    /// cannot send.
    explicit DeviceFrames(const BusDescription& description);

    /// Frames of the joints from positions (rad, all joints) and efforts. `effort` is empty unless the joints
    /// measure the outputs.
    std::vector<hal::Frame> joints(std::span<const double> position, std::span<const double> effort) const;

    /// Frames of the sensor for a wrench (6 values: N, N·m); empty without a sensor.
    std::vector<hal::Frame> wrench(std::span<const double> wrench) const;

    /// The frame that triggers the measurement of synchronous drives; none if no drive is synchronous.
    std::optional<hal::Frame> sync() const;

    /// Status frames that devices send by themselves every `heartbeat_period_ns`.
    std::vector<hal::Frame> heartbeats() const;
    static constexpr std::int64_t heartbeat_period_ns = 100'000'000;

    /// The reply to a request of the host (see BusArm::requests).
    std::optional<hal::Frame> answer(const hal::Frame& request) const;

    /// The replies to all such requests.
    std::vector<hal::Frame> full_scales() const;

  private:
    const JointFamily* family_;
    std::vector<BusBoard> boards_;
    std::optional<AnySensor> sensor_;
    bool synchronous_;
};

} // namespace dfdyn::tools
