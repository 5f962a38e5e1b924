// SPDX-License-Identifier: Apache-2.0
#include "tools/can/check/bus_load.hpp"

#include "tools/can/check/bus_stream.hpp"

#include <algorithm>

namespace dfdyn::tools {

/// Each window begins in the middle of the one before.
void BusLoad::watch(std::int64_t time_ns, double bits, bool is_known) noexcept {
    constexpr std::int64_t half_ns = 100'000'000;
    const std::int64_t half = time_ns / half_ns;
    if (half != half_) {
        half_before_ = half == half_ + 1 ? half_bits_ : Share{};
        half_bits_ = {};
        half_ = half;
    }
    half_bits_.all += bits;
    half_bits_.unknown += is_known ? 0 : bits;
    const double possible_bits = 2 * bit_rate_ * seconds_of(half_ns);
    if (possible_bits > 0) {
        peak_.all = std::max(peak_.all, (half_before_.all + half_bits_.all) / possible_bits);
        peak_.unknown = std::max(peak_.unknown, (half_before_.unknown + half_bits_.unknown) / possible_bits);
    }
}

} // namespace dfdyn::tools
