// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/bus.hpp"
#include "dfdyn/hal/clock/clock_witness.hpp"
#include "dfdyn/hal/log_clock.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace dfdyn::hal {

/// Schedule of the samples.
struct SamplerConfig {
    bool timer = true;            ///< true: periodic; false: at the triggers of the arm
    std::int64_t period_ns = 1;   ///< of the samples, > 0
    std::int64_t delay_ns = 0;    ///< from the time of a periodic sample to its assembly
    std::int64_t patience_ns = 0; ///< without a trigger, before samples are periodic; at least the period
};

/// Assembles the samples of a stream of frames when they are due. Time comes from the frames' stamps
/// (LogClock). So the same frames with the same stamps give bit-identical samples from a bus and from a
/// recording.
///
/// A frame whose stamp is not from the devices' clock (ClockWitness) is taken at the time of the frame
/// before. Up to `most_strays` frames with stamps that are ahead are held. They are dropped if the next stamp
/// is back to normal, and taken if one more frame continues from them or is further ahead. A sample with a
/// missing value waits for the next value, from which it is interpolated, or until that can no longer come.
/// Later samples wait with it, at most `capacity`. Without triggers, samples are periodic and report why they
/// are incomplete, for at most `longest_silence_ns` after the last frame. They continue the last trigger's
/// sample times with the period, so that later triggers still follow them. A trigger that does not is late
/// and makes no sample.
///
/// `Arm`: `take(frame, now)` returns a sample time if one is complete; `update`, `pending` and `assemble` are
/// those of SampleAssembly. `on_sample(assembled, now_ns)` receives every sample in order of time.
template <class Arm, std::size_t capacity = 16>
class Sampler {
  public:
    static constexpr std::int64_t longest_silence_ns = 1'000'000'000;
    /// Largest number of consecutive held frames. Each one more delays the first frames after a silence by
    /// one frame; three are fewer than an arm with a sensor sends in a period. With fewer, frames that an
    /// adapter stamps together would move the clock. Four stamps that are equally far ahead are accepted.
    static constexpr std::size_t most_strays = 3;

    explicit constexpr Sampler(const SamplerConfig& config) noexcept
        : config_(config), delay_ns_(config.delay_ns) {
        config_.period_ns = std::max<std::int64_t>(config_.period_ns, 1);
    }

    /// Takes the next frame, with the state and the counters of its bus at that time.
    template <class OnSample>
    void take(Arm& arm, const Frame& frame, BusState state, const BusCounters& counters,
              OnSample&& on_sample) {
        if (!witness_.shows_clock(frame)) {
            arm.update(state, counters);
            arm.take(frame, now_ns_);
            return;
        }
        if (!started_) {
            start(frame.stamp_ns);
        }
        resolve_held(arm, frame.stamp_ns, on_sample);
        if (holding_ > 0 || clock_.leads(frame.stamp_ns)) {
            held_[holding_++] = {frame, state, counters};
        } else {
            process(arm, frame, state, counters, on_sample);
        }
    }

    /// Declares that no further frame has a stamp up to `stamp_ns`, and assembles the samples that are due by
    /// then. Requires at least one frame.
    template <class OnSample>
    void advance_to(Arm& arm, std::int64_t stamp_ns, OnSample&& on_sample) {
        std::size_t past = 0;
        while (past < holding_ && wrapping_difference(held_[past].frame.stamp_ns, stamp_ns) <= 0) {
            ++past;
        }
        process_held(arm, past, on_sample);
        const std::int64_t end_ns = std::min(clock_.time_of(stamp_ns) + 1, now_ns_ + longest_silence_ns);
        assemble_before(arm, end_ns, on_sample);
        release(arm, end_ns, on_sample);
    }

    /// Declares the end of the frames. Waiting samples are assembled without the missing values.
    template <class OnSample>
    void finish(Arm& arm, OnSample&& on_sample) {
        process_held(arm, holding_, on_sample);
        for (; waiting_ > 0; --waiting_, first_ = next(first_)) {
            on_sample(arm.assemble(instant_[first_], now_ns_), now_ns_);
        }
    }

    /// Return the time of the first frame, and of the last; 0 before.
    [[nodiscard]] constexpr std::int64_t start_ns() const noexcept { return start_ns_; }
    [[nodiscard]] constexpr std::int64_t now_ns() const noexcept { return now_ns_; }
    [[nodiscard]] constexpr bool started() const noexcept { return started_; }
    [[nodiscard]] constexpr const LogClock& clock() const noexcept { return clock_; }

    /// Returns the number of frames dropped because their stamps were ahead of those after them.
    [[nodiscard]] constexpr std::uint64_t strays() const noexcept { return strays_; }

    /// Returns the number of triggers that came too late for a sample.
    [[nodiscard]] constexpr std::uint64_t late_moments() const noexcept { return late_moments_; }

  private:
    /// A frame with the state and the counters of its bus.
    struct Held {
        Frame frame;
        BusState state = BusState::active;
        BusCounters counters;
    };

    [[nodiscard]] static constexpr std::size_t next(std::size_t place) noexcept {
        return (place + 1) % capacity;
    }

    /// Decides by the stamp of the next frame which of the held frames are dropped or taken.
    template <class OnSample>
    void resolve_held(Arm& arm, std::int64_t stamp_ns, OnSample& on_sample) {
        if (holding_ == 0) {
            return;
        }
        const auto ahead_ns = [&] {
            return wrapping_difference(held_[holding_ - 1].frame.stamp_ns, stamp_ns);
        };
        const bool returns = ahead_ns() > LogClock::overtaken_ns;
        const bool further = ahead_ns() < -LogClock::overtaken_ns;
        for (; holding_ > 0 && ahead_ns() > LogClock::overtaken_ns; --holding_) {
            ++strays_;
        }
        if (returns || further || holding_ == most_strays) {
            process_held(arm, holding_, on_sample);
        }
    }

    /// Takes the first `count` held frames.
    template <class OnSample>
    void process_held(Arm& arm, std::size_t count, OnSample& on_sample) {
        for (std::size_t i = 0; i < count; ++i) {
            process(arm, held_[i].frame, held_[i].state, held_[i].counters, on_sample);
        }
        std::move(held_.begin() + count, held_.begin() + holding_, held_.begin());
        holding_ -= count;
    }

    template <class OnSample>
    void process(Arm& arm, const Frame& frame, BusState state, const BusCounters& counters,
                 OnSample& on_sample) {
        const std::int64_t time_ns = clock_.due_ns(frame.stamp_ns);
        assemble_before(arm, std::min(time_ns, now_ns_ + longest_silence_ns), on_sample);
        now_ns_ = time_ns;
        skip_before(now_ns_);
        release(arm, now_ns_, on_sample);
        arm.update(state, counters);
        const std::optional<std::int64_t> moment = arm.take(frame, now_ns_);
        release(arm, now_ns_, on_sample);
        if (moment) {
            take_moment(arm, *moment, on_sample);
        }
    }

    template <class OnSample>
    void take_moment(Arm& arm, std::int64_t moment_ns, OnSample& on_sample) {
        if (newest_by_time_ && moment_ns <= *newest_by_time_ + config_.period_ns / 2) {
            ++late_moments_;
        } else {
            wait(arm, moment_ns, now_ns_, on_sample);
        }
        due_ns_ = now_ns_ + config_.patience_ns;
        delay_ns_ = due_ns_ - (moment_ns + config_.period_ns);
    }

    constexpr void start(std::int64_t stamp_ns) noexcept {
        started_ = true;
        start_ns_ = now_ns_ = stamp_ns;
        due_ns_ = stamp_ns + (config_.timer ? config_.period_ns : config_.patience_ns);
    }

    /// Assembles the periodic samples that are due before `time_ns`.
    template <class OnSample>
    void assemble_before(Arm& arm, std::int64_t time_ns, OnSample& on_sample) {
        for (; due_ns_ < time_ns; due_ns_ += config_.period_ns) {
            release(arm, due_ns_, on_sample);
            const std::int64_t instant_ns = due_ns_ - delay_ns_;
            if (!newest_by_time_ || instant_ns > *newest_by_time_) { // the delay came from a late trigger
                newest_by_time_ = instant_ns;
                wait(arm, instant_ns, due_ns_, on_sample);
            }
        }
    }

    /// Skips the samples that were due during a long silence.
    constexpr void skip_before(std::int64_t time_ns) noexcept {
        if (due_ns_ < time_ns) { // can exceed int64 for stamps of opposite signs
            const auto late_ns = static_cast<std::uint64_t>(wrapping_difference(time_ns, due_ns_));
            const auto past_ns =
                static_cast<std::int64_t>(late_ns % static_cast<std::uint64_t>(config_.period_ns));
            due_ns_ = past_ns == 0 ? time_ns : wrapping_sum(time_ns, config_.period_ns - past_ns);
        }
    }

    /// Assembles a sample now, or after the waiting ones.
    template <class OnSample>
    void wait(Arm& arm, std::int64_t instant_ns, std::int64_t now_ns, OnSample& on_sample) {
        if (waiting_ == 0 && !arm.pending(instant_ns, now_ns)) {
            on_sample(arm.assemble(instant_ns, now_ns), now_ns);
            return;
        }
        if (waiting_ == capacity) {
            on_sample(arm.assemble(instant_[first_], now_ns), now_ns);
            first_ = next(first_);
            --waiting_;
        }
        instant_[(first_ + waiting_) % capacity] = instant_ns;
        ++waiting_;
    }

    /// Assembles the waiting samples that are complete or can no longer become complete.
    template <class OnSample>
    void release(Arm& arm, std::int64_t now_ns, OnSample& on_sample) {
        for (; waiting_ > 0 && !arm.pending(instant_[first_], now_ns); --waiting_, first_ = next(first_)) {
            on_sample(arm.assemble(instant_[first_], now_ns), now_ns);
        }
    }

    SamplerConfig config_;
    ClockWitness witness_;
    LogClock clock_;
    bool started_ = false;
    std::int64_t start_ns_ = 0;
    std::int64_t now_ns_ = 0;   ///< time of the last frame
    std::int64_t due_ns_ = 0;   ///< time of the next periodic sample
    std::int64_t delay_ns_ = 0; ///< from the sample time of a periodic sample to its assembly
    std::optional<std::int64_t> newest_by_time_;   ///< sample time of the last periodic sample
    std::array<std::int64_t, capacity> instant_{}; ///< of the waiting samples; ring buffer
    std::size_t first_ = 0;
    std::size_t waiting_ = 0;
    std::array<Held, most_strays> held_{}; ///< frames whose stamps are ahead
    std::size_t holding_ = 0;
    std::uint64_t strays_ = 0;
    std::uint64_t late_moments_ = 0;
};

} // namespace dfdyn::hal
