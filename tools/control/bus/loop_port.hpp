// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bus.hpp"
#include "tools/can/arm/bus_arm.hpp"
#include "tools/can/arm/torque_frames.hpp"
#include "tools/control/loop/control_loop.hpp"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// Compares a bus' stamps with the ticks in which its readings arrive: a reading that the drain before did
/// not find cannot have been measured long before that drain, nor later than now. A stamp more than half a
/// period beyond that shows that its clock has jumped, by as much as the reading's age has changed.
class ArrivalClock {
  public:
    explicit ArrivalClock(std::int64_t period_ns) noexcept : period_ns_(period_ns) {}

    /// Takes the stamp of the newest reading, after a drain at `now_ns`. `latency_ns`: from measurement to
    /// stamp, at most. O(1).
    void drained(std::int64_t newest_ns, std::int64_t now_ns, std::int64_t latency_ns) noexcept;

    /// A drain at `now_ns` after which no sample was assembled.
    void drained(std::int64_t now_ns) noexcept { drained_ns_ = now_ns; }

    /// What is to be added to stamps so that they are on the clock of the ticks, a multiple of the period.
    std::int64_t correction_ns() const noexcept { return correction_ns_; }

  private:
    std::int64_t period_ns_;
    std::int64_t newest_ns_ = 0, drained_ns_ = 0, usual_age_ns_ = 0, correction_ns_ = 0;
    bool started_ = false;
};

/// What a port did so far.
struct PortCounters {
    std::uint64_t received = 0;                ///< frames
    std::size_t most_in_tick = 0;              ///< frames of one tick
    std::uint64_t overfull_ticks = 0;          ///< that left frames for the next
    std::uint64_t refused = 0;                 ///< frames of ours that were not sent
    std::uint64_t incomplete = 0;              ///< ticks for which no sample had become complete
    std::uint64_t invalid = 0;                 ///< ticks whose sample's positions could not be believed
    std::uint64_t held = 0;                    ///< ticks with a joint whose frame was missing
    std::uint64_t clock_jumps = 0;             ///< corrections of the bus' clock that were begun
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

    /// The measurements for the tick that was due at `tick_ns`; refers to this port. Call it once per tick: a
    /// `tick_ns` that is off by more than half a period from the one before shows that the clock of both was
    /// set, and the measurements go on in the time from before. A joint is missing in it whose value is held
    /// from the reading that the sample before had. Devices are returning while they qualify, or while their
    /// clock is not believed or corrected (hal::Reason).
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
    void follow_ticks(std::int64_t tick_ns) noexcept;
    void follow_clock(const BusSample& sample, std::int64_t now_ns) noexcept;
    bool find_missing(const BusSample& sample, std::int64_t now_ns);

    template <hal::Bus B>
    void offer(B& bus, std::span<const hal::Frame> frames) {
        for (const hal::Frame& frame : frames) {
            counters_.refused += bus.send(frame) == hal::SendResult::sent ? 0 : 1;
        }
    }

    bool timer_, measures_torque_;
    int delay_ticks_;
    std::int64_t period_ns_, latency_ns_;
    std::optional<std::int64_t> next_tick_ns_;
    std::int64_t set_ns_ = 0; ///< by how much the ticks' clock was set since the first
    int ticks_across_ = 0;    ///< to come, whose instant is not clearly after that
    ArrivalClock clock_;
    std::unique_ptr<BusArm> arm_;
    TorqueFrames commands_;
    std::array<hal::Frame, frames_per_tick> room_{};
    std::optional<std::int64_t> moment_;
    bool arrived_ = false; ///< frames, in the last drain
    bool bus_lost_ = false;
    JointVector position_, torque_, command_;
    std::vector<bool> missing_;
    std::vector<std::int64_t> newest_ns_; ///< reading of each joint at the sample before
    std::int64_t next_request_ns_;
    PortCounters counters_;
};

} // namespace dfdyn::tools
