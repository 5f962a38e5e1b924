// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <array>
#include <random>

namespace dfdyn::tests {

/// A random frame of any kind, received or sent by this host or read from a log.
inline hal::Frame random_frame(std::mt19937_64& engine) {
    const auto below = [&](std::uint64_t end) {
        return std::uniform_int_distribution<std::uint64_t>(0, end - 1)(engine);
    };
    constexpr std::array<std::uint8_t, 16> fd_lengths{0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
    hal::Frame frame;
    frame.stamp_ns = static_cast<std::int64_t>(below(9'223'372'036'000'000'000U));
    frame.stamp_source = hal::StampSource::log;
    frame.origin = below(2) == 0 ? hal::Origin::remote : hal::Origin::this_host;
    const std::uint64_t kind = below(4);
    frame.error = kind == 0;
    frame.remote = kind == 1;
    frame.fd = kind == 2;
    frame.extended = !frame.error && below(2) == 0;
    frame.bit_rate_switch = frame.fd && below(2) == 0;
    frame.error_state_indicator = frame.fd && below(2) == 0;
    frame.id = static_cast<std::uint32_t>(below(1U << (frame.error || frame.extended ? 29U : 11U)));
    frame.length = frame.fd ? fd_lengths.at(below(16)) : static_cast<std::uint8_t>(below(9));
    for (std::size_t index = 0; index < frame.length && !frame.remote; ++index) {
        frame.data.at(index) = static_cast<std::uint8_t>(below(256));
    }
    return frame;
}

} // namespace dfdyn::tests
