// SPDX-License-Identifier: Apache-2.0
#include "tools/control/bus/loop_port.hpp"

#include "tools/control/loop/safe_stop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace dfdyn::tools {

namespace {

int delay_of(const BusDescription& description, double loop_period_s) {
    switch (description.trigger) {
    case BusTrigger::sync: // a sample is complete at the SYNC after its own one
        return static_cast<int>(std::lround(1 / (description.joints.rate_hz * loop_period_s)));
    case BusTrigger::timer:
        return static_cast<int>(
            std::lround(static_cast<double>(description.delay_ns) * 1e-9 / loop_period_s));
    case BusTrigger::set:
        break;
    }
    return 0;
}

/// Adapts a description to the loop. The bus does not check joint limits, because JointWatch detects abnormal
/// joints. A joint that was missing no longer than the loop extrapolates need not qualify again.
BusDescription for_loop(BusDescription description, double loop_period_s) {
    constexpr double none = 1e12;
    for (hal::MotionLimits& limits : description.joint_limits) {
        limits = {none, none, none, limits.encoder};
    }
    const int coasted = SafeStopConfig{}.position_patience + 1; // the period with the next reading
    description.joints.max_age_ns =
        std::max<std::int64_t>(description.joints.max_age_ns, std::llround(1e9 * coasted * loop_period_s));
    return description;
}

/// Returns whether some joints have a valid reading and others do not.
bool lacks_single_joints(std::span<const hal::Reason> joints) {
    const auto good = [](hal::Reason reason) { return reason == hal::Reason::ok; };
    return std::ranges::any_of(joints, good) && !std::ranges::all_of(joints, good);
}

/// Returns whether every missing reading is missing temporarily: its device or clock still qualifies.
bool returns(const BusSample& sample) {
    const auto passing = [](hal::Reason reason) {
        return reason == hal::Reason::qualifying || reason == hal::Reason::clock_jumped ||
               reason == hal::Reason::time_not_increasing;
    };
    return passing(sample.report.position) &&
           std::ranges::all_of(sample.joint_reasons(), [&](hal::Reason reason) {
               return reason == hal::Reason::ok || passing(reason);
           });
}

} // namespace

LoopPort::LoopPort(const BusDescription& description, double loop_period_s)
    : trigger_(description.trigger), measures_torque_(description.outputs == OutputKind::joint_torque),
      delay_ticks_(delay_of(description, loop_period_s)), period_ns_(std::llround(loop_period_s * 1e9)),
      latency_ns_(description.joints.latency_ns), clock_(period_ns_),
      arm_(for_loop(description, loop_period_s)), commands_(description),
      position_(JointVector::Zero(description.joint_count)), torque_(position_),
      sent_(static_cast<std::size_t>(delay_ticks_) + 1),
      missing_(static_cast<std::size_t>(description.joint_count)),
      newest_ns_(missing_.size(), std::numeric_limits<std::int64_t>::min()),
      next_request_ns_(std::numeric_limits<std::int64_t>::min()) {}

void LoopPort::count(std::size_t frames) noexcept {
    arrived_ = frames > 0;
    drained_ = frames < frames_per_tick;
    counters_.received += frames;
    counters_.most_in_tick = std::max(counters_.most_in_tick, frames);
    counters_.overfull_ticks += frames == frames_per_tick ? 1 : 0;
}

void ArrivalClock::drained(std::int64_t newest_ns, std::int64_t now_ns, std::int64_t latency_ns) noexcept {
    const std::int64_t age_ns = now_ns - newest_ns;
    const std::int64_t before_drain_ns = drained_ns_ - newest_ns - latency_ns;
    const bool arrived = !started_ || newest_ns != newest_ns_;
    const bool contradicts = started_ && (2 * before_drain_ns > period_ns_ || -2 * age_ns > period_ns_);
    if (arrived && !contradicts) {
        constexpr int memory = 16; // readings
        usual_age_ns_ = started_ ? usual_age_ns_ + (age_ns - usual_age_ns_) / memory : age_ns;
        correction_ns_ = 0;
        started_ = true;
    } else if (arrived) {
        const double periods = static_cast<double>(age_ns - usual_age_ns_) / static_cast<double>(period_ns_);
        correction_ns_ = std::llround(periods) * period_ns_;
    }
    newest_ns_ = newest_ns;
    drained_ns_ = now_ns;
}

void LoopPort::follow_ticks(std::int64_t tick_ns) noexcept {
    const std::int64_t jump_ns = tick_ns - next_tick_ns_.value_or(tick_ns);
    last_set_ns_ = set_ns_;
    if (2 * std::abs(jump_ns) > period_ns_) {
        set_ns_ += jump_ns;
        ++counters_.clock_jumps;
    }
    next_tick_ns_ = tick_ns + period_ns_;
}

/// Returns a stamp on the time scale before all steps of the clock. In the tick of a step, frames may still
/// have a stamp from before it: the correction that leaves the stamp closer to `now_ns` is the right one.
std::int64_t LoopPort::continued(std::int64_t stamp_ns, std::int64_t now_ns) const noexcept {
    const std::int64_t after_ns = stamp_ns - set_ns_, before_ns = stamp_ns - last_set_ns_;
    return std::abs(now_ns - before_ns) < std::abs(now_ns - after_ns) ? before_ns : after_ns;
}

void LoopPort::follow_clock(const BusSample& sample, std::int64_t now_ns) noexcept {
    const std::int64_t age_ns =
        std::ranges::min(std::span(sample.report.position_age_ns).first(missing_.size()));
    if (age_ns < std::numeric_limits<std::int64_t>::max()) {
        const std::int64_t before_ns = clock_.correction_ns();
        clock_.drained(now_ns - age_ns, now_ns, latency_ns_);
        const bool changed = clock_.correction_ns() != before_ns && clock_.correction_ns() != 0;
        counters_.clock_jumps += changed ? 1 : 0;
    }
}

bool LoopPort::find_missing(const BusSample& sample, std::int64_t now_ns) {
    bool any = false;
    for (std::size_t joint = 0; joint < missing_.size(); ++joint) {
        const std::int64_t newest_ns = now_ns - sample.report.position_age_ns[joint];
        missing_[joint] = sample.report.joint_reason[joint] != hal::Reason::ok ||
                          (newest_ns == newest_ns_[joint] && newest_ns < sample.sample.time_ns);
        newest_ns_[joint] = newest_ns;
        any = any || missing_[joint];
    }
    counters_.held += any ? 1 : 0;
    return any;
}

/// Returns the time of the sample for a tick at `now_ns` whose measurement is due at `due_ns`; none without a
/// sample.
std::optional<std::int64_t> LoopPort::sample_time(std::int64_t due_ns, std::int64_t now_ns) noexcept {
    const bool timer = trigger_ == BusTrigger::timer;
    const bool incomplete =
        trigger_ == BusTrigger::set && !moment_ && sampled_ && drained_ && arm_.drop_set(now_ns);
    return timer || incomplete ? std::optional(due_ns - clock_.correction_ns()) : moment_;
}

LoopInput LoopPort::sense(std::int64_t now_ns) {
    now_ns -= set_ns_;
    LoopInput input;
    const std::int64_t due_ns = next_tick_ns_.value_or(0) - set_ns_ - (delay_ticks_ + 1) * period_ns_;
    input.time_ns = due_ns;
    input.bus_lost = bus_lost_;
    const std::optional<std::int64_t> instant = sample_time(due_ns, now_ns);
    if (!instant) {
        ++counters_.incomplete;
        clock_.drained(now_ns);
        input.returning = arrived_ && arm_.bus().clock.doubtful();
        return input;
    }
    const BusSample sample = arm_.assemble(*instant, now_ns);
    const std::int64_t correction_ns = clock_.correction_ns();
    follow_clock(sample, now_ns);
    // or the requested sample time was wrong
    const bool corrected = trigger_ == BusTrigger::timer && clock_.correction_ns() != correction_ns;
    const bool usable = sample.valid() || lacks_single_joints(sample.joint_reasons());
    if (!usable) {
        ++counters_.invalid;
        counters_.last_reason = sample.report.position;
        counters_.last_joint = sample.report.joint;
    }
    input.returning = corrected || (!sample.valid() && returns(sample));
    if (!usable || corrected) {
        return input;
    }
    take(sample, now_ns, input);
    input.time_ns = *instant + clock_.correction_ns();
    // within a tick, devices with a clock of their own measure at any time
    const std::int64_t age_ns = due_ns - input.time_ns;
    take_torque(sample, 2 * age_ns > -period_ns_ && age_ns < period_ns_ + latency_ns_, input);
    return input;
}

/// Passes the valid positions to the loop.
void LoopPort::take(const BusSample& sample, std::int64_t now_ns, LoopInput& input) {
    for (Eigen::Index joint = 0; joint < position_.size(); ++joint) {
        const auto index = static_cast<std::size_t>(joint);
        position_[joint] = sample.report.joint_reason[index] == hal::Reason::ok ? sample.positions()[index]
                                                                                : position_[joint];
    }
    input.position = &position_;
    input.missing = find_missing(sample, now_ns) ? &missing_ : nullptr;
    sampled_ = true;
}

/// Passes the torque at the sample's time to the loop: measured, or the command that was in effect then.
void LoopPort::take_torque(const BusSample& sample, bool on_time, LoopInput& input) {
    if (measures_torque_ && sample.sample.output_valid) {
        torque_ = Eigen::Map<const Eigen::VectorXd>(sample.sample.output.data(), torque_.size());
        input.torque = &torque_;
    } else if (!measures_torque_ && on_time && sends_ >= sent_.size()) {
        input.torque = &sent_[sends_ % sent_.size()];
    }
}

} // namespace dfdyn::tools
