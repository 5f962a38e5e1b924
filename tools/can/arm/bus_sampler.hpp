// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/sampler.hpp"
#include "tools/can/arm/bus_arm.hpp"

#include <cstdint>
#include <functional>
#include <memory>

namespace dfdyn::tools {

/// Makes the samples of a stream of frames when they are due, by the trigger of a bus description; see
/// hal::Sampler.
class BusSampler {
  public:
    /// Gets every sample, with positions or without, in the order of time.
    using OnSample = std::function<void(const BusSample&)>;

    static constexpr std::int64_t longest_silence_ns = hal::Sampler<BusArm>::longest_silence_ns;

    BusSampler(const BusDescription& description, OnSample on_sample);

    /// The next frame; state and counters of its bus as they are with it.
    void take(const hal::Frame& frame, hal::BusState state, const hal::BusCounters& counters);

    /// No frame will come with a stamp up to `stamp_ns`: what is due by then is assembled. A frame must have
    /// come.
    void advance_to(std::int64_t stamp_ns);

    /// No frame will come any more: samples that wait for a missing value are given without.
    void finish();

    /// The time of the first frame; 0 before.
    std::int64_t start_ns() const noexcept { return sampler_.start_ns(); }
    bool started() const noexcept { return sampler_.started(); }
    std::uint64_t frames() const noexcept { return frames_; }
    const BusArm& arm() const noexcept { return *arm_; }

  private:
    std::unique_ptr<BusArm> arm_;
    OnSample on_sample_;
    hal::Sampler<BusArm> sampler_;
    std::uint64_t frames_ = 0;
};

} // namespace dfdyn::tools
