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

/// Compares a bus' time stamps with the ticks in which its readings arrive. A reading that the previous drain
/// did not find was measured at most `latency_ns` before that drain, and not in the future. A stamp more than
/// half a period outside these bounds indicates a jump of the bus' clock, by the change of the reading's age.
class ArrivalClock {
  public:
    explicit ArrivalClock(std::int64_t period_ns) noexcept : period_ns_(period_ns) {}

    /// Evaluates the stamp of the newest reading, after a drain at `now_ns`. `latency_ns`: longest time from
    /// measurement to stamp. O(1).
    void drained(std::int64_t newest_ns, std::int64_t now_ns, std::int64_t latency_ns) noexcept;

    /// Registers a drain at `now_ns` after which no sample was assembled.
    void drained(std::int64_t now_ns) noexcept { drained_ns_ = now_ns; }

    /// Correction of the stamps to the clock of the ticks; a multiple of the period.
    std::int64_t correction_ns() const noexcept { return correction_ns_; }

  private:
    std::int64_t period_ns_;
    std::int64_t newest_ns_ = 0, drained_ns_ = 0, usual_age_ns_ = 0, correction_ns_ = 0;
    bool started_ = false;
};

/// Statistics of a port since its construction.
struct PortCounters {
    std::uint64_t received = 0;                ///< frames
    std::size_t most_in_tick = 0;              ///< frames in one tick, maximum
    std::uint64_t overfull_ticks = 0;          ///< ticks that left frames for the next one
    std::uint64_t refused = 0;                 ///< own frames that were not sent
    std::uint64_t incomplete = 0;              ///< ticks without a complete sample
    std::uint64_t invalid = 0;                 ///< ticks with a sample whose positions were invalid
    std::uint64_t held = 0;                    ///< ticks with at least one joint whose frame was missing
    std::uint64_t clock_jumps = 0;             ///< corrections of the bus' clock
    hal::Reason last_reason = hal::Reason::ok; ///< of the last invalid sample
    int last_joint = hal::unused_joint;        ///< joint of the last invalid sample
};

/// The loop's interface to a bus: receives frames and provides one sample per tick; sends torques as frames.
class LoopPort {
  public:
    /// Maximum number of frames read in one tick. A full bus of 1 Mbit/s carries about 20 frames in a
    /// millisecond.
    static constexpr std::size_t frames_per_tick = 256;

    LoopPort(const BusDescription& description, double loop_period_s);

    /// Receives the frames that have arrived for the tick that is due at `tick_ns`, up to `frames_per_tick`.
    /// Requests from the sensor the data that it must send before it can be used. Call it once per tick.
    ///
    /// If `tick_ns` differs from the expected time by more than half a period, the clock of ticks and stamps
    /// was set. All later times of the bus are corrected by the sum of these steps: the devices' readings
    /// continue on the time scale before the step.
    template <hal::Bus B>
    void receive(B& bus, std::int64_t tick_ns) {
        moment_.reset();
        follow_ticks(tick_ns);
        const std::span<const hal::Frame> frames = bus.drain(room_);
        const std::int64_t now_ns = bus.now_ns() - set_ns_;
        arm_.update(bus.state(), bus.counters());
        for (hal::Frame frame : frames) {
            frame.stamp_ns = continued(frame.stamp_ns, now_ns);
            if (const std::optional<std::int64_t> moment = arm_.take(frame, now_ns)) {
                moment_ = moment;
            }
        }
        count(frames.size());
        bus_lost_ = bus.state() == hal::BusState::off || bus.state() == hal::BusState::interface_down;
        if (now_ns >= next_request_ns_) {
            next_request_ns_ = now_ns + request_period_ns;
            offer(bus, arm_.requests());
        }
    }

    /// Returns the measurements for the tick of the last `receive`, at `now_ns` on the clock of the bus. The
    /// result refers to this port. A joint is `missing` if its value is held from the previous sample's
    /// reading. Devices are `returning` while they qualify, or while their clock is invalid or being
    /// corrected (hal::Reason).
    ///
    /// With the trigger `set`, a tick with a reading of at least one joint does not wait for lost frames. It
    /// receives a sample of its own time without the joints that have no reading. The next tick's set begins
    /// with the next frame. The tick waits for frames that have arrived and were not read yet.
    LoopInput sense(std::int64_t now_ns);

    /// Sends a command. Without measured torques it is also the torque of the next tick's measurement, which
    /// arrives `delay_ticks` after that tick.
    template <hal::Bus B>
    void send(B& bus, const JointVector& torque) {
        sent_[sends_++ % sent_.size()] = torque;
        offer(bus, commands_.encode({torque.data(), static_cast<std::size_t>(torque.size())}));
    }

    /// Number of ticks from a measurement to the tick that receives it.
    int delay_ticks() const noexcept { return delay_ticks_; }
    const PortCounters& counters() const noexcept { return counters_; }

  private:
    static constexpr std::int64_t request_period_ns = 100'000'000;

    void count(std::size_t frames) noexcept;
    void follow_ticks(std::int64_t tick_ns) noexcept;
    std::int64_t continued(std::int64_t stamp_ns, std::int64_t now_ns) const noexcept;
    void follow_clock(const BusSample& sample, std::int64_t now_ns) noexcept;
    std::optional<std::int64_t> sample_time(std::int64_t due_ns, std::int64_t now_ns) noexcept;
    bool find_missing(const BusSample& sample, std::int64_t now_ns);
    void take(const BusSample& sample, std::int64_t now_ns, LoopInput& input);
    void take_torque(const BusSample& sample, bool on_time, LoopInput& input);

    template <hal::Bus B>
    void offer(B& bus, std::span<const hal::Frame> frames) {
        for (const hal::Frame& frame : frames) {
            counters_.refused += bus.send(frame) == hal::SendResult::sent ? 0 : 1;
        }
    }

    BusTrigger trigger_;
    bool measures_torque_;
    int delay_ticks_;
    std::int64_t period_ns_, latency_ns_;
    std::optional<std::int64_t> next_tick_ns_;
    std::int64_t set_ns_ = 0;      ///< sum of all steps of the ticks' clock
    std::int64_t last_set_ns_ = 0; ///< same at the previous tick
    ArrivalClock clock_;
    BusArm arm_;
    TorqueFrames commands_;
    std::array<hal::Frame, frames_per_tick> room_{};
    std::optional<std::int64_t> moment_;
    bool arrived_ = false; ///< whether the last drain received frames
    bool drained_ = false; ///< whether it received all that had arrived
    bool sampled_ = false; ///< whether there has been a sample with positions
    bool bus_lost_ = false;
    JointVector position_, torque_;
    std::vector<JointVector> sent_; ///< ring: commands of the last `delay_ticks_` + 1 ticks
    std::size_t sends_ = 0;
    std::vector<bool> missing_;
    std::vector<std::int64_t> newest_ns_; ///< reading of each joint at the previous sample
    std::int64_t next_request_ns_;
    PortCounters counters_;
};

} // namespace dfdyn::tools
