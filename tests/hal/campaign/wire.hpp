// SPDX-License-Identifier: Apache-2.0
// What devices put on a bus, written from their protocols' documents: nothing here uses the product's
// encoders.
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

inline hal::Frame frame(std::uint32_t id, std::initializer_list<unsigned> bytes) {
    hal::Frame result;
    result.id = id;
    result.length = static_cast<std::uint8_t>(bytes.size());
    std::transform(bytes.begin(), bytes.end(), result.data.begin(),
                   [](unsigned byte) { return static_cast<std::uint8_t>(byte & 0xFFU); });
    return result;
}

inline long long counts(double value, double lowest, double highest) {
    return std::llround(std::clamp(value, lowest, highest));
}
inline unsigned byte_of(long long number, int place) {
    return static_cast<unsigned>(static_cast<unsigned long long>(number) >> (8 * place)) & 0xFFU;
}

/// iCub motor board with two joints: POSITION 0x101 + 16 A, two int32 of ticks, least significant byte first.
inline hal::Frame icub_positions(unsigned address, double ticks_a, double ticks_b) {
    const long long a = counts(ticks_a, -2147483648.0, 2147483647.0);
    const long long b = counts(ticks_b, -2147483648.0, 2147483647.0);
    return frame(0x101U | address << 4U, {byte_of(a, 0), byte_of(a, 1), byte_of(a, 2), byte_of(a, 3),
                                          byte_of(b, 0), byte_of(b, 1), byte_of(b, 2), byte_of(b, 3)});
}
/// STATUS 0x103 + 16 A: flags of joint A, mode A, flags B, mode B, then four bytes of the board.
inline hal::Frame icub_status(unsigned address, unsigned flags_a, unsigned flags_b) {
    return frame(0x103U | address << 4U, {flags_a, 0, flags_b, 0, 0, 0, 0, 0});
}

/// iCub 2FOC: 0x100 + 16 A: current int16 mA, velocity int16, position int32 in 1/65536 turn.
inline hal::Frame foc_motion(unsigned address, double current_A, double turns) {
    const long long i = counts(1000 * current_A, -32768, 32767);
    const long long q = counts(65536 * turns, -2147483648.0, 2147483647.0);
    return frame(0x100U | address << 4U, {byte_of(i, 0), byte_of(i, 1), 0x12, 0x34, byte_of(q, 0),
                                          byte_of(q, 1), byte_of(q, 2), byte_of(q, 3)});
}
/// STATUS 0x103 + 16 A: mode, encoder errors, PWM int16, fault word u32.
inline hal::Frame foc_status(unsigned address, unsigned encoder_errors) {
    return frame(0x103U | address << 4U, {0, encoder_errors, 0, 0, 0, 0, 0, 0});
}

/// CANopen: SYNC without data; a TPDO with 0x6064 int32 and 0x6077 int16; one with 0x6064 cut to 16 bits.
inline hal::Frame sync() { return frame(0x080, {}); }
inline hal::Frame drive_pdo(unsigned node, double position_counts, double torque_counts) {
    const long long q = counts(position_counts, -2147483648.0, 2147483647.0);
    const long long t = counts(torque_counts, -32768, 32767);
    return frame(0x280U + node,
                 {byte_of(q, 0), byte_of(q, 1), byte_of(q, 2), byte_of(q, 3), byte_of(t, 0), byte_of(t, 1)});
}
inline hal::Frame drive_pdo_16(unsigned node, double position_counts, double torque_counts) {
    const long long q = std::llround(position_counts); // the encoder's own counter goes round
    const long long t = counts(torque_counts, -32768, 32767);
    return frame(0x280U + node, {byte_of(q, 0), byte_of(q, 1), byte_of(t, 0), byte_of(t, 1)});
}
inline hal::Frame heartbeat(unsigned node, unsigned state) { return frame(0x700U + node, {state}); }

/// ODrive: 0x09 position and velocity, float, turns; 0x01 heartbeat: error u32, state, three flags.
inline hal::Frame odrive_estimates(unsigned node, double turns, double turns_per_s) {
    const std::array<float, 2> values{static_cast<float>(turns), static_cast<float>(turns_per_s)};
    hal::Frame result = frame(node << 5U | 0x09U, {0, 0, 0, 0, 0, 0, 0, 0});
    std::memcpy(result.data.data(), values.data(), 8); // the test machine is little-endian
    return result;
}
inline hal::Frame odrive_heartbeat(unsigned node, unsigned encoder_flag) {
    return frame(node << 5U | 0x01U, {0, 0, 0, 0, 8, 0, encoder_flag, 0});
}

using SixWords = std::array<long long, 6>;

/// iCub strain: 0x30A + 16 A force, 0x30B + 16 A torque: u16, offset 0x8000, least significant byte first.
inline std::array<hal::Frame, 2> strain(unsigned address, const SixWords& raw) {
    const auto half = [&](unsigned id, std::size_t from) {
        return frame(id | address << 4U,
                     {byte_of(raw[from] + 0x8000, 0), byte_of(raw[from] + 0x8000, 1),
                      byte_of(raw[from + 1] + 0x8000, 0), byte_of(raw[from + 1] + 0x8000, 1),
                      byte_of(raw[from + 2] + 0x8000, 0), byte_of(raw[from + 2] + 0x8000, 1)});
    };
    return {half(0x30AU, 0), half(0x30BU, 3)};
}
/// Its answer to 0x18: 0x200 + 16 A: 0x18, channel, full scale u16, most significant byte first.
inline hal::Frame strain_full_scale(unsigned address, unsigned channel, unsigned full_scale) {
    return frame(0x200U | address << 4U, {0x18, channel, full_scale >> 8U, full_scale});
}

/// Robotous RFT: 16 bytes over two frames: 0x0B, six int16 most significant byte first, overload, 2 bytes.
inline std::array<hal::Frame, 2> robotous(const SixWords& raw) {
    return {frame(0xF9, {0x0B, byte_of(raw[0], 1), byte_of(raw[0], 0), byte_of(raw[1], 1), byte_of(raw[1], 0),
                         byte_of(raw[2], 1), byte_of(raw[2], 0), byte_of(raw[3], 1)}),
            frame(0xFA, {byte_of(raw[3], 0), byte_of(raw[4], 1), byte_of(raw[4], 0), byte_of(raw[5], 1),
                         byte_of(raw[5], 0), 0, 0, 0})};
}

/// ATI NETCANOEM, base 0x20: status u16 and gauges 0, 2, 4; gauges 1, 3, 5: most significant byte first.
inline std::array<hal::Frame, 2> ati(const SixWords& raw) {
    return {frame(0x200, {0, 0, byte_of(raw[0], 1), byte_of(raw[0], 0), byte_of(raw[2], 1),
                          byte_of(raw[2], 0), byte_of(raw[4], 1), byte_of(raw[4], 0)}),
            frame(0x201, {byte_of(raw[1], 1), byte_of(raw[1], 0), byte_of(raw[3], 1), byte_of(raw[3], 0),
                          byte_of(raw[5], 1), byte_of(raw[5], 0)})};
}

} // namespace dfdyn::tests::wire
