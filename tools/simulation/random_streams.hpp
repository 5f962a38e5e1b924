// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// Random streams of a scenario's seed. They are independent, so that a change of one sensor's noise level
/// leaves the rest of a simulation unchanged.
namespace dfdyn::tools::stream {

inline constexpr std::uint32_t wrench_noise = 1;
inline constexpr std::uint32_t encoder_noise = 2;
inline constexpr std::uint32_t torque_noise = 3;
inline constexpr std::uint32_t clock_jitter = 4;
inline constexpr std::uint32_t task = 5;
inline constexpr std::uint32_t controller_model = 6;
inline constexpr std::uint32_t lost_frames = 7;
inline constexpr std::uint32_t output_noise = 100; ///< and following, one per output

} // namespace dfdyn::tools::stream
