// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"
#include "dfdyn/hal/reason.hpp"

#include <array>
#include <concepts>
#include <cstdint>

namespace dfdyn::hal {

/// What a device says about one joint. A value that is not `ok` is not to be used; its number means nothing.
/// What a frame does not carry is `waiting_for_position` or `no_output`.
struct JointValue {
    int joint = 0;             ///< of the arm, from base to tip, counted from 0
    std::int64_t stamp_ns = 0; ///< when it was measured, as far as the device's protocol tells
    Reason position_reason = Reason::waiting_for_position;
    double position_rad = 0;
    bool raw_zero =
        false; ///< the device sent a position of 0, before any zero or scale: perhaps it has none yet
    Reason effort_reason = Reason::no_output;
    double effort = 0;        ///< torque (N·m) or motor current (A), whichever the device measures
    double step_rad = 0;      ///< one count of the position
    double wrap_rad = 0;      ///< what the position's integer holds before it starts again; 0: endless
    double from_zero_rad = 0; ///< from where the device's own number is 0
};

/// Marks a joint of a device that the arm does not have.
inline constexpr int unused_joint = -1;

/// What a decoder makes of one frame.
struct Decoded {
    enum class Kind : std::uint8_t {
        nothing, ///< not for this device, or a message of it that says nothing about a value
        values,  ///< `joints` entries of `joint`; an entry without a position or effort says why
        part,    ///< frame number `part` of a wrench, to be paired with the other one
        status,  ///< the device's condition is now `reason`; its values carry it from here on
        sync,    ///< the moment at which synchronous devices measure
        lost,    ///< the device says that it lost messages
        rejected ///< one of its identifiers, but not a frame that it sends: `reason` says why
    };
    Kind kind = Kind::nothing;
    Reason reason = Reason::ok;
    int joints = 0;
    std::array<JointValue, 2> joint{};
    int part = 0; ///< 0 or 1
};

/// Force (N) and torque (N·m) in the sensor's frame: fx fy fz mx my mz.
using Wrench = std::array<double, 6>;

/// What a pair of frames says. `raw` are the numbers of the frames before any scaling, for whoever wants to
/// know whether they move.
struct WrenchReading {
    Reason reason = Reason::ok;
    std::array<std::int32_t, 6> raw{};
    Wrench value{};
};

/// Up to two frames that a device sends for one set of values.
struct FrameList {
    std::array<Frame, 2> frame{};
    int count = 0;
};

/// A device (or board of a device) that reports joint positions, and perhaps efforts.
/// - `joints`: how many at most.
/// - `decode(frame)`: what the frame says. Any frame may be offered, also one that is not its own.
/// - `claims(id)`: whether it is this device that sends the standard identifier; no other may.
/// - `encode(values)`: the frames that the device sends for these values, one for each of its joints in its
/// own
///   order, with its quantisation and saturation: what a simulated device sends.
template <class S>
concept JointSource = requires(S source, const S constant, const Frame& frame, std::uint32_t id,
                               const std::array<JointValue, static_cast<std::size_t>(S::joints)>& values) {
    { source.decode(frame) }
    noexcept->std::same_as<Decoded>;
    { constant.claims(id) }
    noexcept->std::same_as<bool>;
    { constant.encode(values) }
    noexcept->std::same_as<FrameList>;
};

/// A force/torque sensor. Every one on CAN sends a wrench as two frames.
/// - `decode(frame)`: part 0 or 1 of a wrench, or anything else. What the parts say is read once they are
/// paired.
/// - `wrench(first, second)`: the reading of two frames that `decode` called part 0 and part 1.
/// - `claims`, `encode`: as of a JointSource.
template <class S>
concept WrenchSource = requires(S source, const S constant, const Frame& frame, std::uint32_t id,
                                const Wrench& value) {
    { source.decode(frame) }
    noexcept->std::same_as<Decoded>;
    { constant.wrench(frame, frame) }
    noexcept->std::same_as<WrenchReading>;
    { constant.claims(id) }
    noexcept->std::same_as<bool>;
    { constant.encode(value) }
    noexcept->std::same_as<FrameList>;
};

/// Whether the frame is on this standard identifier and not an error frame.
[[nodiscard]] constexpr bool has_id(const Frame& frame, std::uint32_t id) noexcept {
    return !frame.error && !frame.extended && frame.id == id;
}

/// What is wrong with a frame that should be a classic data frame of exactly `length` bytes.
[[nodiscard]] constexpr Reason check_form(const Frame& frame, int length) noexcept {
    if (frame.remote || frame.fd) {
        return Reason::wrong_frame_type;
    }
    return frame.length == length ? Reason::ok : Reason::wrong_length;
}

[[nodiscard]] constexpr Decoded rejected(Reason reason) noexcept {
    Decoded decoded;
    decoded.kind = Decoded::Kind::rejected;
    decoded.reason = reason;
    return decoded;
}

[[nodiscard]] constexpr Decoded status(Reason reason) noexcept {
    Decoded decoded;
    decoded.kind = Decoded::Kind::status;
    decoded.reason = reason;
    return decoded;
}

/// Frame number `part` of a wrench.
[[nodiscard]] constexpr Decoded wrench_part(int part) noexcept {
    Decoded decoded;
    decoded.kind = Decoded::Kind::part;
    decoded.part = part;
    return decoded;
}

/// An empty classic data frame.
[[nodiscard]] constexpr Frame make_frame(std::uint32_t id, int length) noexcept {
    Frame frame;
    frame.id = id;
    frame.length = static_cast<std::uint8_t>(length);
    return frame;
}

} // namespace dfdyn::hal
