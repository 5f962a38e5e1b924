// SPDX-License-Identifier: Apache-2.0
#include "tools/can/motors/codec_fit.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

using Stamps = std::span<const std::int64_t>;

/// Returns the durations (ns) of all sequences of this number of intervals.
std::vector<std::int64_t> durations_of(Stamps stamps_ns, std::size_t intervals) {
    std::vector<std::int64_t> durations_ns;
    for (std::size_t i = intervals; i < stamps_ns.size(); ++i) {
        durations_ns.push_back(stamps_ns[i] - stamps_ns[i - intervals]);
    }
    return durations_ns;
}

double median_duration_ns(Stamps stamps_ns, std::size_t intervals) {
    std::vector<std::int64_t> durations_ns = durations_of(stamps_ns, intervals);
    const auto middle = durations_ns.begin() + static_cast<std::ptrdiff_t>(durations_ns.size() / 2);
    std::ranges::nth_element(durations_ns, middle);
    return static_cast<double>(*middle);
}

/// Returns the mean rate over about 0.25 s, of the sequences whose duration is close to the median; 0 if the
/// stamps do not increase. `intervals`: of the shortest sequence.
double mean_rate_hz(Stamps stamps_ns, std::size_t intervals) {
    constexpr double long_enough_ns = 250e6; // more than ten bursts of usual adapters
    constexpr double close = 0.15;
    while (median_duration_ns(stamps_ns, intervals) < long_enough_ns && 8 * intervals < stamps_ns.size()) {
        intervals *= 2;
    }
    const double median_ns = median_duration_ns(stamps_ns, intervals);
    double sum_ns = 0;
    double count = 0;
    for (const std::int64_t duration : durations_of(stamps_ns, intervals)) {
        const auto duration_ns = static_cast<double>(duration);
        if (std::abs(duration_ns - median_ns) <= close * median_ns) {
            sum_ns += duration_ns;
            ++count;
        }
    }
    return sum_ns > 0 ? 1e9 * static_cast<double>(intervals) * count / sum_ns : 0;
}

} // namespace

double usual_rate_hz(std::span<const std::int64_t> stamps_ns) {
    constexpr std::size_t most_intervals = 4;
    constexpr double much_shorter = 0.25;    // than the mean interval
    constexpr std::ptrdiff_t in_bursts = 20; // one of so many intervals is much shorter
    if (stamps_ns.size() < 2) {
        return 0;
    }
    const std::size_t intervals = std::min(most_intervals, stamps_ns.size() - 1);
    const double mean_hz = mean_rate_hz(stamps_ns, intervals);
    const std::ptrdiff_t shorter = std::ranges::count_if(
        durations_of(stamps_ns, 1), [&](std::int64_t ns) { return seconds_of(ns) * mean_hz < much_shorter; });
    if (in_bursts * shorter > std::ssize(stamps_ns)) {
        return mean_hz;
    }
    const double median_ns = median_duration_ns(stamps_ns, intervals);
    return median_ns > 0 ? 1e9 * static_cast<double>(intervals) / median_ns : 0;
}

void JointFit::take(const hal::JointValue& value) {
    velocity.take(value);
    efforts += value.effort_reason != hal::Reason::no_output ? 1 : 0;
    if (value.position_reason == hal::Reason::waiting_for_position) {
        return;
    }
    constexpr double fastest = 60; ///< rad/s
    constexpr double least_jump_rad = 0.1;
    const std::int64_t last_ns = position_ns.empty() ? 0 : position_ns.back();
    const double step_s = seconds_of(value.stamp_ns - last_ns);
    const double step_rad = std::abs(value.position_rad - last_rad);
    jumps += !position_ns.empty() && step_rad > least_jump_rad && step_rad > fastest * step_s ? 1 : 0;
    at_end += value.position_reason == hal::Reason::position_out_of_range ? 1 : 0;
    position_ns.push_back(value.stamp_ns);
    last_rad = value.position_rad;
    lowest_rad = std::min(lowest_rad, last_rad);
    highest_rad = std::max(highest_rad, last_rad);
}

bool CodecFit::fits() const noexcept {
    constexpr std::uint64_t most_bad = 10; ///< the largest share of bad frames is 1 / most_bad
    const std::uint64_t positions = joint[0].position_ns.size() + joint[1].position_ns.size();
    const std::uint64_t jumps = joint[0].jumps + joint[1].jumps;
    const std::uint64_t at_end = joint[0].at_end + joint[1].at_end;
    return positions >= frames_to_recognise && 2 * at_end < positions && most_bad * rejected <= values &&
           most_bad * jumps <= positions;
}

} // namespace dfdyn::tools
