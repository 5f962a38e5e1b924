// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// Removes jumps from the time stamps of a bus. A clock that was set, or a single wrong time stamp, would
/// otherwise look like silence, losses or slow sources.
///
/// Frames far ahead of the latest one wait. If one continues from the latest before `silent_after` of them
/// have come, their stamps were outliers; otherwise there was a silence. Frames more than `overtaken_ns`
/// behind the latest, or farther ahead, wait, too. If the following frames continue from the old time stamps,
/// they were outliers. If `adopt_after` frames continue from the new one, the clock was set, and time
/// continues without the step. In a recording, a silence of the same length looks the same. Memory:
/// `adopt_after` frames.
class StreamClock {
  public:
    static constexpr std::int64_t overtaken_ns = 5'000'000;
    /// minimum step ahead; 20 mean intervals if that is longer
    static constexpr std::int64_t least_step_ns = 1'500'000'000;
    static constexpr std::size_t adopt_after = 20;
    static constexpr std::size_t silent_after = 4;

    struct Timed {
        hal::Frame frame;   ///< its time stamp has no jumps
        bool stray = false; ///< its time stamp is meaningless
    };

    /// Returns the frames with a known time, in the order of their arrival. Valid until the next call.
    std::span<const Timed> take(const hal::Frame& frame);

    /// Returns the waiting frames. Call after the last frame.
    std::span<const Timed> finish();

    /// Converts a time of the same clock as the time stamps to time without jumps.
    std::int64_t time_of(std::int64_t stamp_ns) const noexcept;

    std::uint64_t strays() const noexcept { return strays_; }
    /// Number of times the clock was set, and the largest step with its sign.
    std::uint64_t steps() const noexcept { return steps_; }
    std::int64_t largest_step_ns() const noexcept { return largest_step_ns_; }

  private:
    bool goes_on(std::int64_t stamp_ns) const noexcept;
    void follow(hal::Frame frame);
    void adopt();
    void drop_waiting();
    bool hold_ahead(const hal::Frame& frame, std::int64_t step_ns, std::int64_t usual_ns);
    void follow_ahead();

    std::vector<hal::Frame> ahead_; ///< frames after a step ahead, until a silence is confirmed
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
