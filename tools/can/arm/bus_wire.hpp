// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace dfdyn::tools {

/// Bits of a classic frame on the wire, with as many stuffed bits as there can be and the space before the
/// next one.
int frame_bits(const hal::Frame& frame);

/// The wire of a CAN bus: one frame at a time, of those that wait the one with the lowest identifier first.
class BusWire {
  public:
    /// Gets each frame, stamped with its end, in order.
    using OnFrame = std::function<void(const hal::Frame&)>;

    BusWire(double bit_rate, OnFrame on_frame);

    /// A frame that its sender wants to send at `ready_ns`. Frames of one identifier keep their order.
    void offer(const hal::Frame& frame, std::int64_t ready_ns);

    /// Sends what begins before `time_ns`; nothing may be offered for an earlier time any more.
    void send_before(std::int64_t time_ns);
    /// Sends all that was offered; returns the end of the last frame.
    std::int64_t send_all();

    std::uint64_t bits() const noexcept { return bits_; }

  private:
    struct Waiting {
        hal::Frame frame;
        std::int64_t ready_ns;
    };

    void send(std::size_t index, std::int64_t begin_ns);

    double bit_rate_;
    OnFrame on_frame_;
    std::vector<Waiting> waiting_; ///< in the order of their offers
    std::int64_t free_ns_;         ///< the wire is free from then on
    std::uint64_t bits_ = 0;
};

} // namespace dfdyn::tools
