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

/// What a port did so far.
struct PortCounters {
    std::uint64_t received = 0;                ///< frames
    std::size_t most_in_tick = 0;              ///< frames of one tick
    std::uint64_t overfull_ticks = 0;          ///< that left frames for the next
    std::uint64_t refused = 0;                 ///< frames of ours that were not sent
    std::uint64_t incomplete = 0;              ///< ticks for which no sample had become complete
    std::uint64_t invalid = 0;                 ///< ticks whose sample's positions could not be believed
    hal::Reason last_reason = hal::Reason::ok; ///< of those
    int last_joint = hal::unused_joint;        ///< that it is about
};

/// The loop's side of a bus: frames in, the sample of a tick; torques out, as frames.
class LoopPort {
  public:
    /// Frames that one tick reads, at most: a full bus of 1 Mbit/s carries some 20 in a millisecond.
    static constexpr std::size_t frames_per_tick = 256;

    LoopPort(const BusDescription& description, double loop_period_s);

    /// Takes what has arrived, up to that bound; asks the sensor for what it has to tell before it is of use.
    template <hal::Bus B>
    void receive(B& bus) {
        moment_.reset();
        const std::span<const hal::Frame> frames = bus.drain(room_);
        arm_->update(bus.state(), bus.counters());
        for (const hal::Frame& frame : frames) {
            if (const std::optional<std::int64_t> moment = arm_->take(frame, bus.now_ns())) {
                moment_ = moment;
            }
        }
        count(frames.size());
        bus_lost_ = bus.state() == hal::BusState::off || bus.state() == hal::BusState::interface_down;
        if (bus.now_ns() >= next_request_ns_) {
            next_request_ns_ = bus.now_ns() + request_period_ns;
            offer(bus, arm_->requests());
        }
    }

    /// The measurements for the tick that was due at `tick_ns`; refers to this port.
    LoopInput sense(std::int64_t tick_ns, std::int64_t now_ns);

    /// Sends a command, which is kept as the torque of the next tick where the bus has no measured one.
    template <hal::Bus B>
    void send(B& bus, const JointVector& torque) {
        command_ = torque;
        offer(bus, commands_.encode({torque.data(), static_cast<std::size_t>(torque.size())}));
    }

    /// Ticks between a measurement and the tick that gets it.
    int delay_ticks() const noexcept { return delay_ticks_; }
    const PortCounters& counters() const noexcept { return counters_; }

  private:
    static constexpr std::int64_t request_period_ns = 100'000'000;

    void count(std::size_t frames) noexcept;

    template <hal::Bus B>
    void offer(B& bus, std::span<const hal::Frame> frames) {
        for (const hal::Frame& frame : frames) {
            counters_.refused += bus.send(frame) == hal::SendResult::sent ? 0 : 1;
        }
    }

    bool timer_, measures_torque_;
    int delay_ticks_;
    std::int64_t period_ns_;
    std::unique_ptr<BusArm> arm_;
    TorqueFrames commands_;
    std::array<hal::Frame, frames_per_tick> room_{};
    std::optional<std::int64_t> moment_;
    bool bus_lost_ = false;
    JointVector position_, torque_, command_;
    std::int64_t next_request_ns_;
    PortCounters counters_;
};

} // namespace dfdyn::tools
