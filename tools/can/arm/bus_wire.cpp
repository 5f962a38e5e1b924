// SPDX-License-Identifier: Apache-2.0
#include "tools/can/arm/bus_wire.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace dfdyn::tools {

namespace {

/// Bits of the arbitration phase and of the data phase (ISO 11898-1). The CRC of the data phase has fixed
/// stuff bits.
double flexible_frame_bits(const hal::Frame& frame, double data_rate_ratio) {
    const int arbitration = frame.extended ? 36 : 17;
    const int end = 13;
    const int check_sum = frame.length <= 16 ? 17 : 21;
    const int payload = 5 + 8 * frame.length;
    const int data = payload + payload / 4 + 4 + check_sum + (4 + check_sum) / 4 + 1;
    const double ratio = frame.bit_rate_switch ? data_rate_ratio : 1;
    return arbitration + arbitration / 4 + end + data / ratio;
}

} // namespace

double frame_bits(const hal::Frame& frame, double data_rate_ratio) {
    if (frame.fd) {
        return flexible_frame_bits(frame, data_rate_ratio);
    }
    const int stuffed_fields = (frame.extended ? 54 : 34) + 8 * frame.length;
    const int other_fields = 13;
    return stuffed_fields + other_fields + (stuffed_fields - 1) / 4;
}

BusWire::BusWire(double bit_rate, OnFrame on_frame, double data_rate_ratio)
    : bit_rate_(bit_rate), data_rate_ratio_(data_rate_ratio), on_frame_(std::move(on_frame)),
      free_ns_(std::numeric_limits<std::int64_t>::min()) {}

void BusWire::offer(const hal::Frame& frame, std::int64_t ready_ns) { waiting_.push_back({frame, ready_ns}); }

void BusWire::send_before(std::int64_t time_ns) {
    while (!waiting_.empty()) {
        const std::int64_t first_ready_ns =
            std::ranges::min_element(waiting_, {}, &Waiting::ready_ns)->ready_ns;
        const std::int64_t begin_ns = std::max(free_ns_, first_ready_ns);
        if (begin_ns >= time_ns) {
            return;
        }
        std::size_t winner = waiting_.size();
        for (std::size_t i = 0; i < waiting_.size(); ++i) {
            const bool ready = waiting_[i].ready_ns <= begin_ns;
            if (ready && (winner == waiting_.size() || waiting_[i].frame.id < waiting_[winner].frame.id)) {
                winner = i;
            }
        }
        send(winner, begin_ns);
    }
}

std::int64_t BusWire::send_all() {
    send_before(std::numeric_limits<std::int64_t>::max());
    return free_ns_;
}

void BusWire::send(std::size_t index, std::int64_t begin_ns) {
    hal::Frame frame = waiting_[index].frame;
    waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(index));
    const double bits = frame_bits(frame, data_rate_ratio_);
    bits_ += bits;
    free_ns_ = begin_ns + std::llround(1e9 * bits / bit_rate_);
    frame.stamp_ns = free_ns_;
    on_frame_(frame);
}

} // namespace dfdyn::tools
