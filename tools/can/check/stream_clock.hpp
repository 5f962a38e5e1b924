// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// Takes the jumps out of the stamps of a bus, so that a clock that was set, or a stamp that is off, is not
/// taken for silence, losses or slow sources.
///
/// A frame whose stamp is more than `overtaken_ns` behind the latest, or more than a while ahead, waits.
/// Where the frames after it go on from the old stamps, it was a stray. Where `adopt_after` frames go on from
/// it, the clock was set: time goes on without the step. A bus that is silent for so long looks the same in
/// a recording. Memory: `adopt_after` frames.
class StreamClock {
  public:
    static constexpr std::int64_t overtaken_ns = 5'000'000;
    static constexpr std::int64_t least_step_ns = 1'500'000'000; ///< ahead; or 20 mean intervals, if longer
    static constexpr std::size_t adopt_after = 20;

    struct Timed {
        hal::Frame frame;   ///< its stamp without jumps
        bool stray = false; ///< its stamp means nothing
    };

    /// The frames whose time is known now, in the order in which they came. Valid until the next call.
    std::span<const Timed> take(const hal::Frame& frame);

    /// The frames that still wait, after the last one.
    std::span<const Timed> finish();

    /// A time of the same clock as the stamps, without jumps.
    std::int64_t time_of(std::int64_t stamp_ns) const noexcept;

    std::uint64_t strays() const noexcept { return strays_; }
    /// How often the clock was set, and the largest step, signed.
    std::uint64_t steps() const noexcept { return steps_; }
    std::int64_t largest_step_ns() const noexcept { return largest_step_ns_; }

  private:
    bool goes_on(std::int64_t stamp_ns) const noexcept;
    void follow(hal::Frame frame);
    void adopt();
    void drop_waiting();

    std::vector<hal::Frame> waiting_;
    std::vector<Timed> ready_;
    std::int64_t offset_ns_ = 0;
    std::int64_t first_ns_ = 0, latest_ns_ = 0;
    std::uint64_t frames_ = 0;
    std::uint64_t strays_ = 0;
    std::uint64_t steps_ = 0;
    std::int64_t largest_step_ns_ = 0;
};

} // namespace dfdyn::tools
