// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bus.hpp"
#include "tools/can/arm/device_frames.hpp"
#include "tools/can/arm/torque_frames.hpp"
#include "tools/simulation/simulated_plant.hpp"

#include <array>

namespace dfdyn::tools {

/// The devices' end of a bus: sends readings as the frames of the description's devices and receives torque
/// commands. A joint drive sets its torque to zero if no command arrives for `command_timeout_ns`.
class PlantPort {
  public:
    static constexpr std::int64_t command_timeout_ns = 20'000'000;

    /// `torque_sensor`: conversion from torque to current, for drives that measure currents.
    PlantPort(const BusDescription& description, TorqueSensorModel torque_sensor);

    /// Receives commands and answers requests; at most `room_.size()` frames.
    template <hal::Bus B>
    void receive(B& bus) {
        for (const hal::Frame& frame : bus.drain(room_)) {
            take(frame, bus.now_ns());
            if (const std::optional<hal::Frame> answer = devices_.answer(frame)) {
                offer(bus, *answer);
            }
        }
    }

    /// Sends one reading of every sensor. Sends a SYNC before it if drives wait for one, and heartbeats when
    /// they are due.
    template <hal::Bus B>
    void send(B& bus, SimulatedPlant& plant) {
        if (const std::optional<hal::Frame> sync = devices_.sync()) {
            offer(bus, *sync);
        }
        if (bus.now_ns() >= next_heartbeat_ns_) {
            next_heartbeat_ns_ = bus.now_ns() + DeviceFrames::heartbeat_period_ns;
            offer_all(bus, devices_.heartbeats());
        }
        const JointVector torque = plant.torque();
        const JointVector effort = currents_ ? torque_sensor_.current(torque) : torque;
        offer_all(bus, devices_.joints(values(plant.position()), values(effort)));
        if (has_sensor_) {
            offer_all(bus, devices_.wrench({plant.wrench().data(), 6}));
        }
    }

    /// Returns the current torque of the drives, N·m.
    const JointVector& torque(std::int64_t now_ns);

    std::uint64_t commands() const noexcept { return commands_; } ///< frames received
    std::uint64_t timeouts() const noexcept { return timeouts_; } ///< times a torque was set to zero
    std::uint64_t refused() const noexcept { return refused_; }   ///< frames not sent

  private:
    static std::span<const double> values(const JointVector& vector) {
        return {vector.data(), static_cast<std::size_t>(vector.size())};
    }
    void take(const hal::Frame& frame, std::int64_t now_ns);

    template <hal::Bus B>
    void offer(B& bus, const hal::Frame& frame) {
        refused_ += bus.send(frame) == hal::SendResult::sent ? 0 : 1;
    }
    template <hal::Bus B>
    void offer_all(B& bus, const std::vector<hal::Frame>& frames) {
        for (const hal::Frame& frame : frames) {
            offer(bus, frame);
        }
    }

    DeviceFrames devices_;
    TorqueFrames torques_;
    bool has_sensor_;
    bool currents_; ///< whether the drives measure currents
    TorqueSensorModel torque_sensor_;
    std::array<hal::Frame, 256> room_{};
    JointVector torque_;
    std::int64_t next_heartbeat_ns_;
    std::int64_t commanded_ns_ = 0;
    bool driven_ = false;
    std::uint64_t commands_ = 0, timeouts_ = 0, refused_ = 0;
};

} // namespace dfdyn::tools
