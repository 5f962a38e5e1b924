// SPDX-License-Identifier: Apache-2.0
#include "tools/can/arm/bus_sampler.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

BusSampler::BusSampler(const BusDescription& description, OnSample on_sample)
    : arm_(make_bus_arm(description)), on_sample_(std::move(on_sample)),
      timer_(description.trigger == BusTrigger::timer), period_ns_(description.sample_period_ns()),
      delay_ns_(description.delay_ns),
      patience_ns_(std::max({3 * period_ns_, description.joints.max_age_ns, description.output.max_age_ns})) {
}

void BusSampler::take(const hal::Frame& frame, hal::BusState state, const hal::BusCounters& counters) {
    if (!started_) {
        start(frame.stamp_ns);
    }
    const std::int64_t time_ns = clock_.due_ns(frame.stamp_ns);
    assemble_before(std::min(time_ns, now_ns_ + longest_silence_ns));
    now_ns_ = time_ns;
    ++frames_;
    leave_out_before(now_ns_);
    arm_->update(state, counters);
    if (const auto instant_ns = arm_->take(frame, now_ns_)) {
        on_sample_(arm_->assemble(*instant_ns, now_ns_));
        due_ns_ = now_ns_ + patience_ns_;
    }
}

void BusSampler::advance_to(std::int64_t stamp_ns) {
    assemble_before(std::min(clock_.time_of(stamp_ns) + 1, now_ns_ + longest_silence_ns));
}

void BusSampler::start(std::int64_t stamp_ns) {
    started_ = true;
    start_ns_ = now_ns_ = stamp_ns;
    due_ns_ = stamp_ns + (timer_ ? period_ns_ : patience_ns_);
}

/// What is due before `time_ns`.
void BusSampler::assemble_before(std::int64_t time_ns) {
    for (; due_ns_ < time_ns; due_ns_ += period_ns_) {
        on_sample_(arm_->assemble(due_ns_ - delay_ns_, due_ns_));
    }
}

/// Leaves out what a long silence made due.
void BusSampler::leave_out_before(std::int64_t time_ns) {
    if (due_ns_ < time_ns) {
        due_ns_ += (time_ns - due_ns_ + period_ns_ - 1) / period_ns_ * period_ns_;
    }
}

} // namespace dfdyn::tools
