// SPDX-License-Identifier: Apache-2.0
#include "tests/hal/campaign/sight.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tests {

namespace {

constexpr int many = 20; ///< readings of a long run
constexpr std::int64_t set_back_ns = 5'000'000;
constexpr int frames_until_adopted = 20; ///< by ClockGate, after the clock was set back
constexpr std::int64_t stray_ns = 5'000'000;
constexpr std::int64_t left_out_ns = 50'000'000; ///< largest time of those frames

/// Larger than the error of a frame that is one period late.
double jump_rad(double velocity) { return 1e-3 + 3e-3 * std::abs(velocity); }

bool is_between(double value, double one, double other, double tolerance) {
    return value >= std::min(one, other) - tolerance && value <= std::max(one, other) + tolerance;
}

} // namespace

JointSight::JointSight(const FaultSite& site, std::size_t joint) {
    int left_out = 0;
    std::int64_t clock_ns = 0;
    for (const Sent& sent : site.traffic) {
        const bool set_back = sent.clock_ns < clock_ns - set_back_ns;
        set_back_ = set_back_ || set_back;
        left_out = set_back ? frames_until_adopted : std::max(0, left_out - 1);
        if (sent.clock_ns != clock_ns) {
            known_ns_.clear(); // by the stamps, the joint had a different velocity
        }
        clock_ns = sent.clock_ns;
        const std::int64_t time_ns = sent.frame.stamp_ns - sent.clock_ns;
        const bool stray = std::abs(time_ns - sent.true_ns) > stray_ns;
        if (left_out > 0 || stray) {
            continue;
        }
        sync_ns_ = sent.role == Sent::Role::sync ? time_ns : sync_ns_;
        if (!site.is_reading(sent, joint)) {
            continue;
        }
        if (sent.corrupted) {
            blind_.push_back({time_ns, std::max<std::int64_t>(1, time_ns - last_.time_ns), span_ns()});
            show(site, joint, sent, time_ns); // the flipped bit may be a different one
            continue;
        }
        examine(site, joint, sent, time_ns);
    }
    std::ranges::stable_sort(blind_, {}, &Blind::time_ns);
    std::ranges::stable_sort(shown_, {}, &Shown::time_ns);
}

bool JointSight::is_on_line(const Shown& one, const Shown& next, double Shown::*what, double value,
                            double tolerance, std::int64_t from_ns, std::int64_t to_ns) {
    const std::int64_t begin_ns = std::max(from_ns, one.time_ns);
    const std::int64_t end_ns = std::min(to_ns, next.time_ns);
    const double slope =
        next.time_ns == one.time_ns ? 0 : (next.*what - one.*what) / seconds_of(next.time_ns - one.time_ns);
    const auto at = [&](std::int64_t time_ns) {
        return one.*what + slope * seconds_of(time_ns - one.time_ns);
    };
    return begin_ns <= end_ns && is_between(value, at(begin_ns), at(end_ns), tolerance);
}

bool JointSight::is_right(const FaultSite& site, std::size_t joint, const Sent& sent, std::int64_t time_ns) {
    const double t = seconds_of(time_ns);
    const double late_s = seconds_of(site.arm.synchronous ? answer_ns : bus_jitter);
    return !sent.uninformative &&
           is_between(sent.shown[joint].position_rad, site.truth.position(joint, t - late_s),
                      site.truth.position(joint, t), 1e-7);
}

void JointSight::show(const FaultSite& site, std::size_t joint, const Sent& sent, std::int64_t time_ns) {
    const bool answers = site.arm.synchronous && sync_ns_ <= time_ns && time_ns - sync_ns_ < bus_period;
    const wire::Joint& shown = sent.shown[joint];
    shown_.push_back({answers ? sync_ns_ : time_ns, shown.position_rad, shown.effort,
                      is_right(site, joint, sent, time_ns), runs_.size() - 1});
}

void JointSight::examine(const FaultSite& site, std::size_t joint, const Sent& sent, std::int64_t time_ns) {
    const double t = seconds_of(time_ns);
    const double velocity = site.truth.velocity(joint, t);
    const double shown = sent.shown[joint].position_rad;
    const double error = shown - site.truth.position(joint, t);
    const double from_zero = shown - site.arm.zero_rad[joint];
    const double step = site.arm.step_rad[joint];
    const Reading reading{.true_ns = sent.true_ns,
                          .stamp_ns = sent.frame.stamp_ns,
                          .time_ns = time_ns,
                          .shown_rad = shown,
                          .error_rad = error,
                          .right = is_right(site, joint, sent, time_ns)};
    const double motion = 1.5 * std::abs(velocity) * seconds_of(bus_period) + 3 * step;
    take({.begin_ns = sent.true_ns,
          .error_rad = error,
          .from_zero_rad = from_zero,
          .at_zero = std::abs(from_zero) <= motion && !can_move_to(reading, step),
          .velocity = velocity},
         reading);
    show(site, joint, sent, time_ns);
}

bool JointSight::can_move_to(const Reading& reading, double step_rad) const {
    const std::int64_t apart_ns = reading.time_ns - last_.time_ns;
    return last_.true_ns != 0 && apart_ns <= bus_max_age &&
           std::abs(reading.shown_rad - last_.shown_rad) <=
               Truth::most_velocity * seconds_of(apart_ns + bus_jitter) + 2 * step_rad;
}

void JointSight::begin_run(Run seen, const Reading& reading) {
    const double near_rad = jump_rad(seen.velocity);
    const auto earlier = std::find_if(wrong_.rbegin(), wrong_.rend(), [&](const WrongRun& wrong) {
        return std::abs(reading.error_rad - wrong.error_rad) <= near_rad;
    });
    if (earlier != wrong_.rend() && std::abs(reading.error_rad) > near_rad) {
        runs_.push_back(earlier->run);
        runs_.back().begin_ns = seen.begin_ns;
        runs_.back().at_zero = earlier->run.at_zero || seen.at_zero;
        return;
    }
    const Reading& before = last_established_;
    seen.blind_ns = before.true_ns == 0
                        ? 0
                        : std::max(reading.true_ns - before.true_ns, reading.stamp_ns - before.stamp_ns) +
                              (set_back_ ? left_out_ns : 0);
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
        if (wrong_.empty() || wrong_.back().number != runs_.size()) {
            wrong_.push_back({run, runs_.size(), 0});
        }
        wrong_.back().error_rad = reading.error_rad;
    }
    const std::int64_t needed_ns = std::min(run.blind_ns, longest_trial_ns);
    right_ = reading.right ? right_ + 1 : 0;
    if (right_ >= 2 && reading.true_ns - run.begin_ns >= needed_ns) {
        last_established_ = reading;
        set_back_ = false;
        wrong_.clear();
    }
    const std::int64_t right_ns = last_established_.time_ns;
    blind_.push_back({reading.time_ns,
                      reading.right ? 0 : std::max<std::int64_t>(1, reading.time_ns - right_ns), span_ns()});
    if (reading.right) {
        if (!known_ns_.empty() && reading.time_ns - known_ns_.back() > bus_max_age + 2 * bus_track_jitter) {
            known_ns_.clear(); // the velocity may have changed
        }
        known_ns_.push_back(reading.time_ns);
    }
    if (known_ns_.size() > 4) {
        known_ns_.pop_front();
    }
}

const JointSight::Run& JointSight::run_at(std::int64_t true_ns) const {
    const auto later = std::ranges::upper_bound(runs_, true_ns, {}, &Run::begin_ns);
    return later == runs_.begin() ? runs_.front() : *(later - 1);
}

std::int64_t JointSight::span_ns() const {
    return known_ns_.size() < 2 ? 0 : std::max<std::int64_t>(0, known_ns_.back() - known_ns_.front());
}

JointSight::Blind JointSight::blind_at(std::int64_t time_ns) const {
    Blind longest{};
    for (auto at = std::ranges::lower_bound(blind_, time_ns - bus_max_age, {}, &Blind::time_ns);
         at != blind_.end() && at->time_ns <= time_ns + bus_max_age; ++at) {
        longest = at->blind_ns > longest.blind_ns ? *at : longest;
    }
    return longest;
}

} // namespace dfdyn::tests
