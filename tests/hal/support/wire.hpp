// SPDX-License-Identifier: Apache-2.0
// Frames as devices send them, written from the protocols' documents without the product's encoders.
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <numbers>

namespace dfdyn::tests::wire {

inline constexpr double turn = 2 * std::numbers::pi; // rad
inline constexpr double degrees = 180 / std::numbers::pi;

/// Values of a joint's device.
struct Joint {
    double position_rad = 0;
    double velocity = 0; ///< rad/s
    double effort = 0;   ///< N·m or A
};
using Joints = std::array<Joint, 2>;

/// The frames of one board, or of one wrench.
struct Frames {
    std::array<hal::Frame, 3> frame{};
    std::size_t count = 0;
};

/// A wrench in counts of the sensor.
using SixWords = std::array<long long, 6>;

inline hal::Frame frame(std::uint32_t id, std::initializer_list<unsigned> bytes) {
    hal::Frame result;
    result.id = id;
    result.length = static_cast<std::uint8_t>(bytes.size());
    std::transform(bytes.begin(), bytes.end(), result.data.begin(),
                   [](unsigned byte) { return static_cast<std::uint8_t>(byte & 0xFFU); });
    return result;
}

inline Frames one(const hal::Frame& only) { return {{only, {}}, 1}; }

/// Returns the nearest integer within the limits.
inline long long counts(double value, double lowest, double highest) {
    return std::llround(std::clamp(value, lowest, highest));
}
/// Returns the code of `bits` bits for a value in ±maximum.
inline long long linear_code(double value, double maximum, int bits) {
    const double largest = std::exp2(bits) - 1;
    return counts((value + maximum) / (2 * maximum) * largest, 0, largest);
}
inline long long int16(double value) { return counts(value, -32768, 32767); }
inline long long int32(double value) { return counts(value, -2147483648.0, 2147483647.0); }

inline unsigned byte_of(long long number, int place) {
    return static_cast<unsigned>(static_cast<unsigned long long>(number) >> (8 * place)) & 0xFFU;
}

/// Feedback of the MIT mode: byte 0, position u16, velocity u12, torque u12, most significant byte first,
/// and the last two bytes.
inline hal::Frame mit_feedback(std::uint32_t id, unsigned first, const Joint& joint,
                               const std::array<double, 3>& maximum, const std::array<unsigned, 2>& last) {
    const long long q = linear_code(joint.position_rad, maximum[0], 16);
    const long long v = linear_code(joint.velocity, maximum[1], 12);
    const long long t = linear_code(joint.effort, maximum[2], 12);
    return frame(id, {first, byte_of(q, 1), byte_of(q, 0), byte_of(v >> 4, 0),
                      byte_of(v << 4, 0) | byte_of(t >> 8, 0), byte_of(t, 0), last[0], last[1]});
}

} // namespace dfdyn::tests::wire
