// SPDX-License-Identifier: Apache-2.0
#include "tests/hal/campaign/sight.hpp"

#include <cmath>

namespace dfdyn::tests {

namespace {

constexpr int many = 20; ///< readings
constexpr std::int64_t set_back_ns = 5'000'000;
constexpr int frames_until_adopted = 20; ///< of a clock that was set back
constexpr std::int64_t stray_ns = 5'000'000;

/// More than a frame that comes late by as much as a period is off.
double jump_rad(double velocity) { return 1e-3 + 3e-3 * std::abs(velocity); }

bool is_between(double value, double one, double other, double tolerance) {
    return value >= std::min(one, other) - tolerance && value <= std::max(one, other) + tolerance;
}

} // namespace

JointSight::JointSight(const FaultSite& site, std::size_t joint) {
    int left_out = 0;
    std::int64_t clock_ns = 0;
    for (const Sent& sent : site.traffic) {
        left_out = sent.clock_ns < clock_ns - set_back_ns ? frames_until_adopted : std::max(0, left_out - 1);
        clock_ns = sent.clock_ns;
        const std::int64_t time_ns = sent.frame.stamp_ns - sent.clock_ns;
        const bool stray = std::abs(time_ns - sent.true_ns) > stray_ns;
        if (left_out > 0 || stray || !site.has_position(sent, joint)) {
            continue;
        }
        if (sent.corrupted) {
            blind_.push_back({time_ns, std::max<std::int64_t>(1, time_ns - last_.time_ns)});
            continue;
        }
        const double t = seconds_of(time_ns);
        const double velocity = site.truth.velocity(joint, t);
        const double shown = sent.shown[joint].position_rad;
        const double error = shown - site.truth.position(joint, t);
        const double late_s = site.arm.synchronous ? 0.6e-3 : seconds_of(bus_jitter);
        take({.begin_ns = sent.true_ns,
              .error_rad = error,
              .from_zero_rad = shown - site.arm.zero_rad[joint],
              .velocity = velocity},
             {.true_ns = sent.true_ns,
              .stamp_ns = sent.frame.stamp_ns,
              .time_ns = time_ns,
              .error_rad = error,
              .right = !sent.uninformative && is_between(shown, site.truth.position(joint, t - late_s),
                                                         site.truth.position(joint, t), 1e-7)});
    }
    std::ranges::stable_sort(blind_, {}, &Blind::time_ns);
}

void JointSight::begin_run(Run seen, const Reading& reading) {
    const double near_rad = jump_rad(seen.velocity);
    const bool goes_on = wrong_.readings >= many && std::abs(reading.error_rad) > near_rad &&
                         std::abs(reading.error_rad - wrong_rad_) <= near_rad;
    if (goes_on) {
        wrong_.begin_ns = seen.begin_ns;
        runs_.push_back(wrong_);
        return;
    }
    const Reading& before = last_established_;
    seen.blind_ns = before.true_ns == 0
                        ? 0
                        : std::max(reading.true_ns - before.true_ns, reading.stamp_ns - before.stamp_ns);
    runs_.push_back(seen);
}

void JointSight::take(Run seen, const Reading& reading) {
    constexpr std::int64_t longest_trial_ns = 420'000'000;
    const double near_rad = jump_rad(seen.velocity);
    const bool jumps = std::abs(reading.error_rad - last_.error_rad) > near_rad;
    const std::int64_t apart_ns =
        std::max(reading.true_ns - last_.true_ns, reading.stamp_ns - last_.stamp_ns);
    if (jumps || apart_ns > bus_max_age + 2 * bus_track_jitter) {
        begin_run(seen, reading);
    }
    Run& run = runs_.back();
    ++run.readings;
    last_ = reading;
    if (std::abs(reading.error_rad) > near_rad && run.readings >= many) {
        wrong_ = run;
        wrong_rad_ = reading.error_rad;
    }
    const std::int64_t needed_ns = std::min(run.blind_ns, longest_trial_ns);
    if (reading.right && reading.true_ns - run.begin_ns >= needed_ns) {
        last_established_ = reading;
    }
    const std::int64_t right_ns = last_established_.time_ns;
    blind_.push_back(
        {reading.time_ns, reading.right ? 0 : std::max<std::int64_t>(1, reading.time_ns - right_ns)});
}

const JointSight::Run& JointSight::run_at(std::int64_t true_ns) const {
    const auto later = std::ranges::upper_bound(runs_, true_ns, {}, &Run::begin_ns);
    return later == runs_.begin() ? runs_.front() : *(later - 1);
}

std::int64_t JointSight::blind_at(std::int64_t time_ns) const {
    std::int64_t longest_ns = 0;
    for (auto at = std::ranges::lower_bound(blind_, time_ns - bus_max_age, {}, &Blind::time_ns);
         at != blind_.end() && at->time_ns <= time_ns + bus_max_age; ++at) {
        longest_ns = std::max(longest_ns, at->blind_ns);
    }
    return longest_ns;
}

} // namespace dfdyn::tests
