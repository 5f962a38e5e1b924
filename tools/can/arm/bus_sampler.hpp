// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/sampler.hpp"
#include "tools/can/arm/bus_arm.hpp"

#include <cstdint>
#include <functional>

namespace dfdyn::tools {

/// Assembles samples from a stream of frames at the times given by the trigger of a bus description; see
/// hal::Sampler.
class BusSampler {
  public:
    /// Called for every sample in the order of time, with or without positions.
    using OnSample = std::function<void(const BusSample&)>;

    static constexpr std::int64_t longest_silence_ns = hal::Sampler<BusArm>::longest_silence_ns;

    BusSampler(const BusDescription& description, OnSample on_sample);

    /// Takes the next frame with the state and counters of its bus at that time.
    void take(const hal::Frame& frame, hal::BusState state, const hal::BusCounters& counters);

    /// Declares that no further frame has a time stamp up to `stamp_ns`, and assembles the samples that are
    /// due by then. Requires at least one frame.
    void advance_to(std::int64_t stamp_ns);

    /// Declares the end of the frames. Samples that wait for a missing value are delivered without it.
    void finish();

    /// Time of the first frame; 0 before it.
    std::int64_t start_ns() const noexcept { return sampler_.start_ns(); }
    bool started() const noexcept { return sampler_.started(); }
    std::uint64_t frames() const noexcept { return frames_; }
    /// Frames that were left out because their stamps were ahead of those after them.
    std::uint64_t strays() const noexcept { return sampler_.strays(); }
    /// Triggers that came too late for a sample.
    std::uint64_t late_moments() const noexcept { return sampler_.late_moments(); }
    const BusArm& arm() const noexcept { return arm_; }

  private:
    BusArm arm_;
    OnSample on_sample_;
    hal::Sampler<BusArm> sampler_;
    std::uint64_t frames_ = 0;
};

} // namespace dfdyn::tools
