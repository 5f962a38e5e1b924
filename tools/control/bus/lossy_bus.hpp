// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bus.hpp"
#include "tools/simulation/faults/fault.hpp"
#include "tools/simulation/random_streams.hpp"

#include <random>

namespace dfdyn::tools {

/// Decides at random which frames are lost, reproducibly for one seed.
class Losses {
  public:
    explicit Losses(std::uint64_t seed) {
        std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                               stream::lost_frames};
        engine_.seed(sequence);
    }

    /// Returns true if the next frame is lost, with probability `share`. Draws a random number only if 0 <
    /// share < 1.
    bool next(double share) noexcept {
        constexpr double step = 0x1p-53;
        return share > 0 && step * static_cast<double>(engine_() >> 11U) < share;
    }

  private:
    std::mt19937_64 engine_;
};

/// The devices' end of a bus that loses frames in both directions, according to a scenario's faults
/// (hal::Bus). The sender of a lost frame does not notice the loss.
template <hal::Bus B>
class LossyBus {
  public:
    LossyBus(B& bus, std::uint64_t seed) : bus_(bus), losses_(seed) {}

    void set_faults(const LinkFaults& faults) noexcept { faults_ = faults; }

    std::span<const hal::Frame> drain(std::span<hal::Frame> into) noexcept {
        const std::size_t count = bus_.drain(into).size();
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count; ++i) {
            if (!losses_.next(faults_.share_lost)) {
                into[kept++] = into[i];
            }
        }
        return into.first(kept);
    }

    hal::SendResult send(const hal::Frame& frame) noexcept {
        const bool lost = faults_.devices_silent || losses_.next(faults_.share_lost);
        return lost ? hal::SendResult::sent : bus_.send(frame);
    }

    std::int64_t now_ns() const noexcept { return bus_.now_ns(); }
    hal::BusState state() const noexcept { return bus_.state(); }
    const hal::BusCounters& counters() const noexcept { return bus_.counters(); }

  private:
    B& bus_;
    Losses losses_;
    LinkFaults faults_;
};

} // namespace dfdyn::tools
