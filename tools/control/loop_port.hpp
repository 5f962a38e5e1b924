// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bus.hpp"
#include "tools/can/bus_arm.hpp"
#include "tools/can/torque_frames.hpp"
#include "tools/control/control_loop.hpp"

#include <array>
#include <memory>
#include <optional>

namespace dfdyn::tools {

/// The loop's side of a bus: frames in, the sample of a tick; torques out, as frames. One tick reads at most
/// `rounds` · 64 frames.
class LoopPort {
  public:
    LoopPort(const BusDescription& description, double loop_period_s);

    /// Takes what has arrived.
    template <hal::Bus B>
    void receive(B& bus) {
        moment_.reset();
        for (int round = 0; round < rounds; ++round) {
            const std::span<const hal::Frame> frames = bus.drain(room_);
            arm_->update(bus.state(), bus.counters());
            for (const hal::Frame& frame : frames) {
                if (const std::optional<std::int64_t> moment = arm_->take(frame, bus.now_ns())) {
                    moment_ = moment;
                }
            }
            if (frames.size() < room_.size()) {
                break;
            }
        }
        bus_lost_ = bus.state() == hal::BusState::off || bus.state() == hal::BusState::interface_down;
    }

    /// The measurements for the tick that was due at `tick_ns`; refers to this port.
    LoopInput sense(std::int64_t tick_ns, std::int64_t now_ns);

    /// Sends a command, which is kept as the torque of the next tick where the bus has no measured one.
    template <hal::Bus B>
    void send(B& bus, const JointVector& torque) {
        command_ = torque;
        for (const hal::Frame& frame :
             commands_.encode({torque.data(), static_cast<std::size_t>(torque.size())})) {
            refused_ += bus.send(frame) == hal::SendResult::sent ? 0 : 1;
        }
    }

    /// Ticks between a measurement and the tick that gets it.
    int delay_ticks() const noexcept { return delay_ticks_; }
    std::uint64_t refused() const noexcept { return refused_; } ///< command frames not sent
    const BusArm& arm() const noexcept { return *arm_; }

  private:
    static constexpr int rounds = 4;

    bool timer_, measures_torque_;
    int delay_ticks_;
    std::int64_t period_ns_;
    std::unique_ptr<BusArm> arm_;
    TorqueFrames commands_;
    std::array<hal::Frame, 64> room_{};
    std::optional<std::int64_t> moment_;
    bool bus_lost_ = false;
    JointVector position_, torque_, command_;
    std::uint64_t refused_ = 0;
};

} // namespace dfdyn::tools
