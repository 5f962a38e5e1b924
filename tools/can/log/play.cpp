// SPDX-License-Identifier: Apache-2.0
#include "tools/can/log/play.hpp"

#include "dfdyn/hal/socketcan_bus.hpp"
#include "tools/base/system/real_time.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/can/log/candump_log.hpp"

#include <algorithm>

namespace dfdyn::tools {
namespace {

/// Throws InputError unless the whole log is readable and contains frames.
void read_through(const PlayOptions& options) {
    CandumpLog log(options.log, options.log_interface);
    hal::ReplayEntry entry;
    std::uint64_t frames = 0;
    while (log.next(entry)) {
        ++frames;
    }
    log.check();
    if (frames == 0) {
        throw InputError(shown(options.log) + ": expected frames" +
                         (options.log_interface.empty() ? "" : " of " + in_quotes(options.log_interface)) +
                         ", found none");
    }
}

/// Plays a log that was read successfully before.
class Player {
  public:
    Player(const PlayOptions& options, const std::atomic<bool>& stop)
        : log_(options.log, options.log_interface), bus_({.interface = options.interface}), stop_(stop),
          times_(bus_.now_ns() + start_delay_ns, options.rate) {}

    PlayOutcome run() {
        outcome_.not_real_time = become_real_time();
        hal::ReplayEntry entry;
        while (!stop_ && log_.next(entry)) {
            play_frame(entry.frame);
        }
        log_.check();
        warn_of_torn_line(log_);
        outcome_.sent = bus_.counters().sent;
        outcome_.backward_stamps = times_.backward_stamps();
        outcome_.median_lateness_us = lateness_.median_us();
        outcome_.worst_lateness_us = lateness_.worst_us();
        outcome_.stopped = stop_;
        return outcome_;
    }

  private:
    static constexpr std::int64_t start_delay_ns = 10'000'000; ///< time to prepare the first frames
    /// Bounds the delay if a signal arrives just before a sleep, which it then does not end.
    static constexpr std::int64_t longest_sleep_ns = 100'000'000;

    void play_frame(const hal::Frame& frame) {
        const std::int64_t due_ns = times_.due_ns(frame.stamp_ns);
        while (!stop_ && bus_.now_ns() < due_ns) {
            sleep_until(std::min(due_ns, bus_.now_ns() + longest_sleep_ns));
        }
        if (stop_) {
            return;
        }
        lateness_.add((bus_.now_ns() - due_ns) / 1000);
        if (frame.error) {
            ++outcome_.error_frames;
            return;
        }
        // The bus reopens its interface only while it is drained.
        bus_.drain(room_);
        outcome_.refused += bus_.send(frame) == hal::SendResult::sent ? 0 : 1;
    }

    CandumpLog log_;
    hal::SocketCanBus bus_;
    const std::atomic<bool>& stop_;
    PlayTimes times_;
    Lateness lateness_;
    PlayOutcome outcome_;
    std::array<hal::Frame, 64> room_{};
};

} // namespace

std::int64_t PlayTimes::due_ns(std::int64_t stamp_ns) {
    if (started_ && stamp_ns > last_stamp_ns_) {
        elapsed_ns_ += static_cast<double>(stamp_ns - last_stamp_ns_) / rate_;
    }
    backward_stamps_ += started_ && stamp_ns < last_stamp_ns_ ? 1 : 0;
    started_ = true;
    last_stamp_ns_ = stamp_ns;
    constexpr double longest_ns = 9e18;
    return start_ns_ + static_cast<std::int64_t>(std::min(elapsed_ns_, longest_ns));
}

void Lateness::add(std::int64_t lateness_us) {
    ++counts_.at(static_cast<std::size_t>(std::clamp<std::int64_t>(lateness_us, 0, longest_us)));
    ++total_;
    worst_us_ = std::max(worst_us_, lateness_us);
}

std::int64_t Lateness::median_us() const {
    std::uint64_t below = 0;
    for (std::size_t lateness_us = 0; lateness_us < counts_.size(); ++lateness_us) {
        below += counts_.at(lateness_us);
        if (2 * below >= total_) {
            return static_cast<std::int64_t>(lateness_us);
        }
    }
    return 0;
}

PlayOutcome play(const PlayOptions& options, const std::atomic<bool>& stop) {
    if (std::filesystem::is_regular_file(options.log)) {
        read_through(options);
    }
    try {
        return Player(options, stop).run();
    } catch (const hal::BusError& error) {
        throw InputError(error.what());
    }
}

} // namespace dfdyn::tools
