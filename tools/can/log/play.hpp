// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>

namespace dfdyn::tools {

/// What to put on which CAN interface, how fast.
struct PlayOptions {
    std::filesystem::path log;
    std::string log_interface; ///< whose frames; empty for a log that has only one
    std::string interface;
    double rate = 1.0; ///< times the log's own speed
};

struct PlayOutcome {
    std::uint64_t sent = 0;
    std::uint64_t refused = 0;         ///< the interface was down, its queue full, or it is no CAN FD
    std::uint64_t error_frames = 0;    ///< in the log; only a controller can send such
    std::uint64_t backward_stamps = 0; ///< frames sent at once because their stamp was earlier than the last
    std::int64_t median_lateness_us = 0; ///< of sending, behind the log's own time
    std::int64_t worst_lateness_us = 0;
    bool stopped = false;      ///< before the log's end
    std::string not_real_time; ///< why the timing is that of an ordinary program; empty: it is not
};

/// When each frame of a log is due, on the clock of the machine that plays it. A stamp that runs backward
/// starts the log's time anew at the frame before.
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

/// Counts latenesses; their median to 1 us up to 10 ms, in fixed memory.
class Lateness {
  public:
    void add(std::int64_t lateness_us);
    /// 0 where nothing was added; 10,000 when the median is beyond.
    std::int64_t median_us() const;
    std::int64_t worst_us() const noexcept { return worst_us_; }

  private:
    static constexpr std::int64_t longest_us = 10'000;
    std::array<std::uint64_t, longest_us + 1> counts_{};
    std::uint64_t total_ = 0;
    std::int64_t worst_us_ = 0;
};

/// Puts the frames of a log on a CAN interface with the log's own timing, each at an absolute time, so that
/// lateness does not add up. Reads an ordinary file through before it sends the first frame. Ends early when
/// `stop` becomes true; a signal that sets it also ends the wait for the next frame. Throws InputError for a
/// log that is malformed or has no frames, and for an interface that cannot be opened.
PlayOutcome play(const PlayOptions& options, const std::atomic<bool>& stop);

} // namespace dfdyn::tools
