// SPDX-License-Identifier: Apache-2.0
#include "tools/can/check/stream_clock.hpp"

#include "dfdyn/hal/bits.hpp"

#include <algorithm>
#include <cstdlib>

namespace dfdyn::tools {

using hal::wrapping_difference;
using hal::wrapping_sum;

std::span<const StreamClock::Timed> StreamClock::take(const hal::Frame& frame) {
    ready_.clear();
    const std::int64_t step_ns = wrapping_difference(wrapping_sum(frame.stamp_ns, offset_ns_), latest_ns_);
    const std::int64_t mean_ns =
        frames_ > 1 ? (latest_ns_ - first_ns_) / static_cast<std::int64_t>(frames_ - 1) : 0;
    const std::int64_t usual_ns = frames_ > 1 ? std::max(overtaken_ns, 20 * mean_ns) : least_step_ns;
    if (frames_ == 0 || (step_ns >= -overtaken_ns && step_ns <= std::max(least_step_ns, 20 * mean_ns))) {
        drop_waiting();
        if (!hold_ahead(frame, step_ns, usual_ns)) {
            follow(frame);
        }
        return ready_;
    }
    if (!waiting_.empty() && !goes_on(frame.stamp_ns)) {
        drop_waiting();
    }
    waiting_.push_back(frame);
    if (waiting_.size() == adopt_after) {
        adopt();
    }
    return ready_;
}

std::span<const StreamClock::Timed> StreamClock::finish() {
    constexpr std::size_t convincing = 3;
    ready_.clear();
    follow_ahead();
    waiting_.size() >= convincing ? adopt() : drop_waiting();
    return ready_;
}

std::int64_t StreamClock::time_of(std::int64_t stamp_ns) const noexcept {
    const std::int64_t time_ns = wrapping_sum(stamp_ns, offset_ns_);
    return frames_ == 0 ? time_ns : std::max(time_ns, latest_ns_);
}

/// Returns true if the frame waits, or if it ended a silence and was delivered with the waiting frames.
bool StreamClock::hold_ahead(const hal::Frame& frame, std::int64_t step_ns, std::int64_t usual_ns) {
    const bool goes_on =
        !ahead_.empty() && wrapping_difference(frame.stamp_ns, ahead_.back().stamp_ns) >= -overtaken_ns;
    if (!goes_on) { // the waiting frames do not belong to a silence
        for (const hal::Frame& stray : ahead_) {
            ready_.push_back({stray, true});
        }
        strays_ += ahead_.size();
        ahead_.clear();
    }
    if (!goes_on && (frames_ == 0 || step_ns <= usual_ns)) {
        return false;
    }
    ahead_.push_back(frame);
    if (ahead_.size() == silent_after) {
        follow_ahead();
    }
    return true;
}

void StreamClock::follow_ahead() {
    for (const hal::Frame& frame : ahead_) {
        follow(frame);
    }
    ahead_.clear();
}

bool StreamClock::goes_on(std::int64_t stamp_ns) const noexcept {
    const std::int64_t step_ns = wrapping_difference(stamp_ns, waiting_.back().stamp_ns);
    return step_ns >= -overtaken_ns && step_ns <= least_step_ns;
}

void StreamClock::follow(hal::Frame frame) {
    frame.stamp_ns = wrapping_sum(frame.stamp_ns, offset_ns_);
    first_ns_ = frames_ == 0 ? frame.stamp_ns : first_ns_;
    latest_ns_ = frames_ == 0 ? frame.stamp_ns : std::max(latest_ns_, frame.stamp_ns);
    ++frames_;
    ready_.push_back({frame, false});
}

/// Adopts the new clock. Its first frame is placed one mean interval after the last frame of the old clock.
void StreamClock::adopt() {
    follow_ahead();
    const std::int64_t old_ns = wrapping_sum(waiting_.front().stamp_ns, offset_ns_);
    const std::int64_t mean_ns = wrapping_difference(waiting_.back().stamp_ns, waiting_.front().stamp_ns) /
                                 static_cast<std::int64_t>(waiting_.size() - 1);
    const std::int64_t step_ns = wrapping_difference(old_ns, latest_ns_);
    offset_ns_ =
        wrapping_difference(latest_ns_ + std::max<std::int64_t>(mean_ns, 0), waiting_.front().stamp_ns);
    ++steps_;
    largest_step_ns_ = std::abs(step_ns) > std::abs(largest_step_ns_) ? step_ns : largest_step_ns_;
    for (const hal::Frame& frame : waiting_) {
        follow(frame);
    }
    waiting_.clear();
}

void StreamClock::drop_waiting() {
    for (const hal::Frame& frame : waiting_) {
        ready_.push_back({frame, true});
    }
    strays_ += waiting_.size();
    waiting_.clear();
}

} // namespace dfdyn::tools
