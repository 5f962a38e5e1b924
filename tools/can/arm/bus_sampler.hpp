// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/log_clock.hpp"
#include "tools/can/arm/bus_arm.hpp"

#include <cstdint>
#include <functional>
#include <memory>

namespace dfdyn::tools {

/// Makes the samples of a stream of frames when they are due, by the trigger of a bus description. Time is
/// what the frames' stamps say, so that the same frames with the same stamps give the same samples, bit for
/// bit, whether they come from a bus or from a recording; see hal::LogClock for stamps that run backward.
///
/// Where a SYNC, or a set, fails to come, samples are assembled at the sample rate instead, and say why they
/// are incomplete; for `longest_silence_ns` at most after the last frame.
class BusSampler {
  public:
    /// Gets every sample, with positions or without, in the order of time.
    using OnSample = std::function<void(const BusSample&)>;

    static constexpr std::int64_t longest_silence_ns = 1'000'000'000;

    BusSampler(const BusDescription& description, OnSample on_sample);

    /// The next frame; state and counters of its bus as they are with it.
    void take(const hal::Frame& frame, hal::BusState state, const hal::BusCounters& counters);

    /// No frame will come with a stamp up to `stamp_ns`: what is due by then is assembled. A frame must have
    /// come.
    void advance_to(std::int64_t stamp_ns);

    /// The time of the first frame; 0 before.
    std::int64_t start_ns() const noexcept { return start_ns_; }
    bool started() const noexcept { return started_; }
    std::uint64_t frames() const noexcept { return frames_; }
    const BusArm& arm() const noexcept { return *arm_; }

  private:
    void start(std::int64_t stamp_ns);
    void assemble_before(std::int64_t time_ns);
    void leave_out_before(std::int64_t time_ns);

    std::unique_ptr<BusArm> arm_;
    OnSample on_sample_;
    bool timer_;
    std::int64_t period_ns_;
    std::int64_t delay_ns_;
    std::int64_t patience_ns_; ///< after the last SYNC or set
    bool started_ = false;
    std::uint64_t frames_ = 0;
    std::int64_t start_ns_ = 0;
    hal::LogClock clock_;
    std::int64_t now_ns_ = 0; ///< of the last frame, by that clock
    std::int64_t due_ns_ = 0; ///< of the next sample that time alone calls for
};

} // namespace dfdyn::tools
