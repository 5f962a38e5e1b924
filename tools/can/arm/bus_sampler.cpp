// SPDX-License-Identifier: Apache-2.0
#include "tools/can/arm/bus_sampler.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

namespace {

hal::SamplerConfig config_of(const BusDescription& description) {
    const std::int64_t period_ns = description.sample_period_ns();
    return {.timer = description.trigger == BusTrigger::timer,
            .period_ns = period_ns,
            .delay_ns = description.delay_ns,
            .patience_ns =
                std::max({3 * period_ns, description.joints.max_age_ns, description.output.max_age_ns})};
}

} // namespace

BusSampler::BusSampler(const BusDescription& description, OnSample on_sample)
    : arm_(description), on_sample_(std::move(on_sample)), sampler_(config_of(description)) {}

void BusSampler::take(const hal::Frame& frame, hal::BusState state, const hal::BusCounters& counters) {
    ++frames_;
    sampler_.take(arm_, frame, state, counters,
                  [this](const BusSample& sample, std::int64_t /*now_ns*/) { on_sample_(sample); });
}

void BusSampler::advance_to(std::int64_t stamp_ns) {
    sampler_.advance_to(arm_, stamp_ns,
                        [this](const BusSample& sample, std::int64_t /*now_ns*/) { on_sample_(sample); });
}

void BusSampler::finish() {
    sampler_.finish(arm_, [this](const BusSample& sample, std::int64_t /*now_ns*/) { on_sample_(sample); });
}

} // namespace dfdyn::tools
