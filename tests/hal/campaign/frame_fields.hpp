// SPDX-License-Identifier: Apache-2.0
// Where the campaign's frames have their values, for faults that change them.
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <cstring>
#include <numbers>

namespace dfdyn::tests {

struct Bytes {
    int begin;
    int length;
};

inline bool is_two_joint_board(const hal::Frame& frame) { return frame.id == 0x111; }
inline bool is_foc(const hal::Frame& frame) { return frame.id == 0x130 || frame.id == 0x140; }
inline bool is_odrive(const hal::Frame& frame) { return frame.id == 0x29 || frame.id == 0x49; }
inline bool is_dbc(const hal::Frame& frame) { return frame.id == 0x120 || frame.id == 0x121; }
inline bool has_effort(const hal::Frame& frame) { return !is_two_joint_board(frame) && !is_odrive(frame); }

inline Bytes position_bytes(const hal::Frame& frame, int joint) {
    if (is_two_joint_board(frame)) {
        return {4 * joint, 4};
    }
    return is_foc(frame) ? Bytes{4, 4} : is_odrive(frame) ? Bytes{0, 4} : Bytes{0, frame.length - 2};
}
inline Bytes effort_bytes(const hal::Frame& frame) {
    return is_foc(frame) ? Bytes{0, 2} : Bytes{frame.length - 2, 2};
}

inline void clear_position(hal::Frame& frame, int joint) {
    const auto [begin, length] = position_bytes(frame, joint);
    std::fill_n(frame.data.begin() + begin, length, std::uint8_t{0});
}

/// Most significant byte first.
inline std::int32_t swapped(std::int32_t counts) {
    return static_cast<std::int32_t>(__builtin_bswap32(static_cast<std::uint32_t>(counts)));
}

/// In the device's unit.
inline double position_of(const hal::Frame& frame, int joint) {
    const auto [begin, length] = position_bytes(frame, joint);
    if (is_odrive(frame)) {
        float turns = 0;
        std::memcpy(&turns, frame.data.data(), 4);
        return static_cast<double>(turns);
    }
    std::int32_t counts = 0;
    std::memcpy(&counts, frame.data.data() + begin, static_cast<std::size_t>(length));
    counts = is_dbc(frame) ? swapped(counts) : counts;
    return length == 2 ? static_cast<std::int16_t>(counts) : counts;
}
/// Of the device's unit, for a radian of the joint.
inline double per_radian(const hal::Frame& frame) {
    constexpr double radians = 2 * std::numbers::pi; // in a turn
    switch (frame.id) {
    case 0x111:
        return 91 * 360 / radians;
    case 0x29:
        return 1 / radians;
    case 0x49:
        return 8 / radians;
    case 0x120:
    case 0x121:
        return 1e6;
    default:
        return (is_foc(frame) ? 2 * 65536 : frame.length == 4 ? 65536 : 1048576) / radians;
    }
}
inline void set_position(hal::Frame& frame, int joint, double position) {
    const auto [begin, length] = position_bytes(frame, joint);
    if (is_odrive(frame)) {
        const auto turns = static_cast<float>(position);
        std::memcpy(frame.data.data(), &turns, 4);
        return;
    }
    const auto rounded = static_cast<std::int32_t>(std::llround(position));
    const std::int32_t counts = is_dbc(frame) ? swapped(rounded) : rounded;
    std::memcpy(frame.data.data() + begin, &counts, static_cast<std::size_t>(length));
}

/// Where one of the four bits is that are worth 6 to 100 mrad; of a float's mantissa.
inline int stuck_place(const hal::Frame& frame, int joint, int bit) {
    const int begin = position_bytes(frame, joint).begin;
    if (is_dbc(frame)) {
        return 8 * (begin + 3 - (13 + bit) / 8) + (13 + bit) % 8;
    }
    const int lowest = is_two_joint_board(frame) ? 5
                       : is_foc(frame)           ? 8
                       : is_odrive(frame)        ? 14
                       : frame.length == 4       ? 7
                                                 : 11;
    return 8 * begin + lowest + bit;
}
inline bool position_bit(const hal::Frame& frame, int joint, int bit) {
    const int place = stuck_place(frame, joint, bit);
    return (frame.data[static_cast<std::size_t>(place / 8)] >> place % 8 & 1) != 0;
}
inline void set_position_bit(hal::Frame& frame, int joint, int bit, bool value) {
    const int place = stuck_place(frame, joint, bit);
    std::uint8_t& byte = frame.data[static_cast<std::size_t>(place / 8)];
    byte = static_cast<std::uint8_t>((byte & ~(1 << place % 8)) | (value ? 1 << place % 8 : 0));
}

/// The wrench's frame as its sensor sends it when it is overloaded.
inline void saturate_half(hal::Frame& frame, int half) {
    if (frame.id == 0x3DA || frame.id == 0x3DB) {
        frame.length = 7;
        frame.data[6] = 0x0A;
    } else if (frame.id == 0xFA) {
        frame.data[5] = 0x20;
    } else if (frame.id == 0x200 && half == 0) {
        frame.data[2] = 0x7F;
        frame.data[3] = 0xFF;
    }
}

inline std::uint32_t other_node(std::uint32_t id) {
    constexpr std::uint32_t pairs[][2] = {{0x130, 0x140}, {0x281, 0x282}, {0x29, 0x49}, {0x120, 0x121}};
    for (const auto& pair : pairs) {
        if (id == pair[0] || id == pair[1]) {
            return pair[0] + pair[1] - id;
        }
    }
    return id;
}

} // namespace dfdyn::tests
