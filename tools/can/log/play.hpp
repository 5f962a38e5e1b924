// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>

namespace dfdyn::tools {

/// Log, CAN interface and speed of a playback.
struct PlayOptions {
    std::filesystem::path log;
    std::string log_interface; ///< interface in the log; empty for a log that has only one
    std::string interface;
    double rate = 1.0; ///< multiple of the log's own speed
};

struct PlayOutcome {
    std::uint64_t sent = 0;
    std::uint64_t refused = 0; ///< the interface was down, its queue was full, or it does not support CAN FD
    std::uint64_t error_frames = 0; ///< error frames in the log, which only a controller can send
    /// frames sent immediately because their time stamp was earlier than the last
    std::uint64_t backward_stamps = 0;
    std::int64_t median_lateness_us = 0; ///< delay of sending relative to the log's time
    std::int64_t worst_lateness_us = 0;
    bool stopped = false;      ///< before the end of the log
    std::string not_real_time; ///< the reason why the process has no real-time priority; empty: it has
};

/// Computes the time at which each frame of a log is due, on the clock of the playing machine. When a time
/// stamp runs backward, the log's time restarts at the previous frame.
class PlayTimes {
  public:
    PlayTimes(std::int64_t start_ns, double rate) : start_ns_(start_ns), rate_(rate) {}

    /// The first frame is due at the start.
    std::int64_t due_ns(std::int64_t stamp_ns);

    std::uint64_t backward_stamps() const noexcept { return backward_stamps_; }

  private:
    std::int64_t start_ns_;
    double rate_;
    double elapsed_ns_ = 0.0; ///< exact to 1 ns for 100 days
    std::int64_t last_stamp_ns_ = 0;
    std::uint64_t backward_stamps_ = 0;
    bool started_ = false;
};

/// Histogram of the lateness. The median has a resolution of 1 us up to 10 ms; the memory is fixed.
class Lateness {
  public:
    void add(std::int64_t lateness_us);
    /// Returns 0 if nothing was added, and 10,000 if the median is larger.
    std::int64_t median_us() const;
    std::int64_t worst_us() const noexcept { return worst_us_; }

  private:
    static constexpr std::int64_t longest_us = 10'000;
    std::array<std::uint64_t, longest_us + 1> counts_{};
    std::uint64_t total_ = 0;
    std::int64_t worst_us_ = 0;
};

/// Sends the frames of a log on a CAN interface with the timing of the log. Each frame has an absolute due
/// time, so that delays do not accumulate. A regular file is read completely before the first frame is sent.
/// Ends early when `stop` becomes true; a signal that sets it also ends the wait for the next frame. Throws
/// InputError for a log that is malformed or has no frames, and for an interface that cannot be opened.
PlayOutcome play(const PlayOptions& options, const std::atomic<bool>& stop);

} // namespace dfdyn::tools
