// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace dfdyn::tools {

/// Number of bits of a frame on the wire, with the largest number of stuff bits and the interframe space.
/// Bits after the switch of the bit rate (CAN FD) count 1 / `data_rate_ratio`: data bit rate / bit rate.
double frame_bits(const hal::Frame& frame, double data_rate_ratio = 1);

/// The wire of a CAN bus. It carries one frame at a time: among the waiting frames, the one with the lowest
/// identifier.
class BusWire {
  public:
    /// Called for each frame in order; its time stamp is the time of its end.
    using OnFrame = std::function<void(const hal::Frame&)>;

    BusWire(double bit_rate, OnFrame on_frame, double data_rate_ratio = 1);

    /// Adds a frame that its sender wants to send at `ready_ns`. Frames with one identifier keep their order.
    void offer(const hal::Frame& frame, std::int64_t ready_ns);

    /// Sends all frames that begin before `time_ns`. Later offers must not be for an earlier time.
    void send_before(std::int64_t time_ns);
    /// Sends all offered frames and returns the end of the last one.
    std::int64_t send_all();

    double bits() const noexcept { return bits_; }

  private:
    struct Waiting {
        hal::Frame frame;
        std::int64_t ready_ns;
    };

    void send(std::size_t index, std::int64_t begin_ns);

    double bit_rate_, data_rate_ratio_;
    OnFrame on_frame_;
    std::vector<Waiting> waiting_; ///< in order of arrival
    std::int64_t free_ns_;         ///< time from which the wire is free
    double bits_ = 0;
};

} // namespace dfdyn::tools
