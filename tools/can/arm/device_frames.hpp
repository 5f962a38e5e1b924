// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/description/bus_description.hpp"

#include <optional>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// What the devices of a bus description send, with their quantisation and saturation: the frames of
/// simulated devices, or of a recording that is put on a bus. Frames have no stamps; whoever sends them
/// stamps them.
class DeviceFrames {
  public:
    /// Throws InputError where a sensor's full scale or calibration is not in the description: it cannot send
    /// without.
    explicit DeviceFrames(const BusDescription& description);

    /// Positions (rad, all joints) and, where the joints measure the outputs, efforts; else none.
    std::vector<hal::Frame> joints(std::span<const double> position, std::span<const double> effort) const;

    /// The sensor's frames of a wrench (6 values); none without a sensor.
    std::vector<hal::Frame> wrench(std::span<const double> wrench) const;

    /// That synchronous drives are to measure; none if no drive does.
    std::optional<hal::Frame> sync() const;

    /// What devices send unasked, every `heartbeat_period_ns`, to say that they are well.
    std::vector<hal::Frame> heartbeats() const;
    static constexpr std::int64_t heartbeat_period_ns = 100'000'000;

    /// The answer to a request of the host, as of BusArm::requests.
    std::optional<hal::Frame> answer(const hal::Frame& request) const;

    /// The answers to all of them.
    std::vector<hal::Frame> full_scales() const;

  private:
    const JointFamily* family_;
    std::vector<BusBoard> boards_;
    std::optional<AnySensor> sensor_;
    bool synchronous_;
};

} // namespace dfdyn::tools
