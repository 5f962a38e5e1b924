// SPDX-License-Identifier: Apache-2.0
#include "tools/can/check/bus_stream.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <set>

namespace dfdyn::tools {

namespace {

constexpr std::size_t intervals_to_infer = 32;
/// share of the period: intervals that differ by less are considered equal
constexpr double same_period = 0.3;
constexpr double same_mean = 0.05;    ///< relative: between the period and the mean interval
constexpr double phase_gain = 0.125;  ///< gain of the phase-locked loop
constexpr double steady_share = 0.75; ///< fraction of the first intervals
constexpr double recent_share = 0.02; ///< weight of a frame in the recent average
constexpr double shorter_than_a_period = 0.9;
constexpr double longer_than_a_period = 1.5;
constexpr double most_off_sequence = 0.4; ///< share of the period: largest distance from the sequence

} // namespace

void BusStream::take(const hal::Frame& frame, double frame_bits, bool is_overtaken) {
    const bool first = count == 0;
    ++count;
    bits += frame_bits;
    overtaken += is_overtaken ? 1 : 0;
    length = frame.length;
    if (first) {
        first_ns = last_ns = frame.stamp_ns;
        last_frame_ = frame;
        waiting_forms_ = 0;
        return;
    }
    const bool repeats = frame.length == last_frame_.length && frame.data == last_frame_.data;
    const double interval_periods = seconds_of(frame.stamp_ns - last_ns) * expected_hz;
    copies += repeats && interval_periods < shorter_than_a_period ? 1 : 0;
    replacing_forms_ += interval_periods > longer_than_a_period ? waiting_forms_ : 0;
    waiting_forms_ = 0;
    last_frame_ = frame;
    take_interval(frame.stamp_ns - last_ns, is_overtaken);
    last_ns = std::max(last_ns, frame.stamp_ns);
}

void BusStream::take_interval(std::int64_t interval_ns, bool is_overtaken) {
    not_increasing += interval_ns <= 0 ? 1 : 0;
    longest_gap_ns = std::max(longest_gap_ns, interval_ns);
    interval_square_sum_s2_ += seconds_of(interval_ns) * seconds_of(interval_ns);
    if (expected_hz > 0) {
        follow_phase(last_ns + interval_ns, interval_ns, is_overtaken);
    } else if (infers && first_intervals_.size() < intervals_to_infer) {
        first_intervals_.push_back(interval_ns);
        if (first_intervals_.size() == intervals_to_infer) {
            infer_period();
        }
    }
}

/// Infers the period as the mean of the intervals close to the median, if most intervals are. Several devices
/// that answer on one identifier send bursts, whose intervals are shorter than the mean. The next intervals
/// are then tried, because losses or a pause may have made the difference.
void BusStream::infer_period() {
    std::vector<std::int64_t> sorted = first_intervals_;
    std::ranges::sort(sorted);
    const auto median_ns = static_cast<double>(sorted[sorted.size() / 2]);
    double sum_ns = 0;
    double close = 0;
    for (const std::int64_t interval_ns : sorted) {
        if (std::abs(static_cast<double>(interval_ns) - median_ns) < same_period * median_ns) {
            sum_ns += static_cast<double>(interval_ns);
            ++close;
        }
    }
    const auto intervals = static_cast<double>(sorted.size());
    const double mean_ns = std::accumulate(sorted.begin(), sorted.end(), 0.0) / intervals;
    const bool steady = median_ns > 0 && close >= steady_share * intervals;
    if (steady && std::abs(close * mean_ns / sum_ns - 1) > same_mean) {
        first_intervals_.clear();
        return;
    }
    expected_hz = steady ? 1e9 * close / sum_ns : 0;
}

void BusStream::follow_phase(std::int64_t stamp_ns, std::int64_t interval_ns, bool is_overtaken) {
    const double period_ns = 1e9 / expected_hz;
    const auto now_ns = static_cast<double>(stamp_ns);
    const double periods = static_cast<double>(interval_ns) / period_ns;
    ++followed_;
    if (waited(stamp_ns, period_ns)) {
        return;
    }
    if (std::abs(periods - 1) < same_period) {
        ++regular_;
        regular_periods_ += periods;
    }
    if (!phase_known_ || periods > gap_periods) {
        next_ns_ = now_ns + period_ns;
        phase_known_ = true;
        in_sequence_ = skipped_ = false;
        return;
    }
    const double skipped = std::round((now_ns - next_ns_) / period_ns);
    missing_ += static_cast<std::int64_t>(skipped);
    recent_additional_ = std::max(0.0, (1 - recent_share) * recent_additional_ - skipped);
    largest_recent_ = std::max(largest_recent_, recent_additional_);
    const double due_ns = next_ns_ + skipped * period_ns;
    const bool late_by_a_period = skipped_ && skipped < 0; // the previous frame was out of sequence
    const bool off = late_by_a_period || std::abs(now_ns - due_ns) > most_off_sequence * period_ns;
    off_sequence_ += off && !is_overtaken ? 1 : 0;
    in_sequence_ = !off && skipped == 0;
    phase_.take(stamp_ns, due_ns, period_ns);
    skipped_ = skipped > 0;
    next_ns_ = due_ns + phase_gain * (now_ns - due_ns) + period_ns;
}

bool BusStream::waited(std::int64_t stamp_ns, double period_ns) {
    if (several) {
        return false;
    }
    if (!phase_known_) {
        backlog_.emplace(static_cast<std::int64_t>(period_ns));
    }
    const bool waits = backlog_->waited(stamp_ns);
    missing_ -= waits && skipped_ ? 1 : 0; // counted as missing by the first frame after the pause
    return waits;
}

void BusStream::forget_phase() noexcept {
    phase_known_ = false;
    phase_.interrupt();
}

double BusStream::rate_hz() const {
    return count > 1 && last_ns > first_ns ? static_cast<double>(count - 1) / seconds_of(last_ns - first_ns)
                                           : 0;
}

double BusStream::jitter_s() const {
    if (count < 3 || last_ns == first_ns) {
        return 0;
    }
    const double mean_s = 1 / rate_hz();
    return std::sqrt(
        std::max(0.0, interval_square_sum_s2_ / static_cast<double>(count - 1) - mean_s * mean_s));
}

std::uint64_t BusStream::missing() const {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(missing_, 0));
}

std::uint64_t BusStream::other_forms() const noexcept {
    return count == 0 ? other_forms_ : 2 * replacing_forms_ > other_forms_ ? replacing_forms_ : 0;
}

std::uint64_t BusStream::additional() const {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(-missing_, 0));
}

double BusStream::missing_share() const {
    const auto lost = static_cast<double>(missing());
    return count > 0 ? lost / (lost + static_cast<double>(count)) : 0;
}

bool BusStream::is_regular() const {
    const double mean = regular_ > 0 ? regular_periods_ / static_cast<double>(regular_) : 0;
    return 2 * regular_ >= followed_ && std::abs(mean - 1) < same_mean;
}

std::string id_text(const BusStreamKey& key) {
    std::array<char, 16> text{};
    std::snprintf(text.data(), text.size(), key.first ? "0x%08X" : "0x%03X", key.second);
    return text.data();
}

std::int64_t common_phase_step_ns(const BusStreams& streams) {
    constexpr double same_step = 0.2; // share of the period
    std::vector<const BusStream*> regular;
    std::set<std::string> senders;
    for (const auto& [key, stream] : streams) {
        if (stream.expected_hz > 0 && !stream.several && stream.is_regular()) {
            regular.push_back(&stream);
            senders.insert(stream.sender);
        }
    }
    if (senders.size() < 2) {
        return 0;
    }
    std::int64_t largest_ns = 0;
    for (const PhaseStep& step : regular.front()->phase_steps()) {
        const bool all = std::ranges::all_of(regular, [&](const BusStream* stream) {
            const double period_ns = 1e9 / stream->expected_hz;
            return std::ranges::any_of(stream->phase_steps(), [&](const PhaseStep& other) {
                const double apart_ns = std::abs(seconds_of(other.time_ns - step.time_ns)) * 1e9;
                const double off_ns = std::remainder(other.step_ns - step.step_ns, period_ns);
                return apart_ns < 3 * period_ns && std::abs(off_ns) < same_step * period_ns;
            });
        });
        if (all && std::abs(step.step_ns) > std::abs(static_cast<double>(largest_ns))) {
            largest_ns = std::llround(step.step_ns);
        }
    }
    return largest_ns;
}

} // namespace dfdyn::tools
