// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"
#include "dfdyn/hal/reason.hpp"

#include <array>
#include <concepts>
#include <cstdint>

namespace dfdyn::hal {

/// Values of one joint in a frame. A value whose reason is not `ok` must not be used; its number is
/// meaningless. Values that the frame does not carry have the reason `waiting_for_position` or `no_output`.
struct JointValue {
    int joint = 0;             ///< joint of the arm, counted from 0 at the base
    std::int64_t stamp_ns = 0; ///< time of measurement, as far as the protocol defines it
    Reason position_reason = Reason::waiting_for_position;
    double position_rad = 0;
    bool raw_zero =
        false; ///< the device sent position 0, before any zero or scale; it may have no position yet
    Reason effort_reason = Reason::no_output;
    double effort = 0;         ///< torque (N·m) or motor current (A), depending on the device
    double step_rad = 0;       ///< size of one count of the position
    double wrap_rad = 0;       ///< range of the position's integer before it wraps; 0: it does not wrap
    double from_zero_rad = 0;  ///< position relative to the device's own zero
    bool has_velocity = false; ///< the frame carries a velocity
    double velocity = 0;       ///< rad/s of the joint, as the device reports it
};

/// Marks a joint of a device that is not a joint of the arm.
inline constexpr int unused_joint = -1;

/// Result of decoding one frame.
struct Decoded {
    enum class Kind : std::uint8_t {
        nothing, ///< a frame of another device, or one without information about values
        values,  ///< `joints` entries of `joint`; an entry without a position or effort has the reason
        part,    ///< frame number `part` of a wrench, to be paired with the other one
        status,  ///< the condition of the device is `reason` from now on, and its values carry it
        sync,    ///< the time at which synchronous devices measure
        lost,    ///< the device reports that it lost messages
        rejected ///< one of its identifiers, but not a frame that the device sends; the cause is `reason`
    };
    Kind kind = Kind::nothing;
    Reason reason = Reason::ok;
    int joints = 0;
    std::array<JointValue, 2> joint{};
    int part = 0; ///< 0 or 1
};

/// Force (N) and torque (N·m) in the sensor's frame: fx fy fz mx my mz.
using Wrench = std::array<double, 6>;

/// A wrench decoded from a pair of frames. `raw` contains the numbers of the frames before any scaling, so
/// that a frozen sensor can be detected.
struct WrenchReading {
    Reason reason = Reason::ok;
    std::array<std::int32_t, 6> raw{};
    Wrench value{};
};

/// Up to three frames that a device sends for one set of values.
struct FrameList {
    std::array<Frame, 3> frame{};
    int count = 0;
};

/// A device, or one board of a device, that reports joint positions and possibly efforts.
/// - `joints`: the largest number of joints.
/// - `decode(frame)`: decodes any frame, including frames of other devices.
/// - `claims(id)`: returns true if this device, and no other, may send the standard identifier.
/// - `concerns(frame)`, optional: returns true for all its frames, also those sent to it (see `concerns`).
/// - `encode(values)`: the frames that the device sends for these values, with its quantisation and
///   saturation; one value for each of its joints, in its own order. For simulated devices.
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

/// A force/torque sensor. Every CAN sensor sends a wrench as two frames.
/// - `decode(frame)`: part 0 or 1 of a wrench, or any other result. The values are read once the parts are
///   paired.
/// - `wrench(first, second)`: the reading from two frames that `decode` identified as part 0 and part 1.
/// - `claims`, `encode`: like those of a JointSource.
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

/// Returns true if the frame has this standard identifier and is not an error frame.
[[nodiscard]] constexpr bool has_id(const Frame& frame, std::uint32_t id) noexcept {
    return !frame.error && !frame.extended && frame.id == id;
}

/// Checks that the frame is a classic data frame of exactly `length` bytes. Returns ok or the reason.
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

/// Returns true if the frame belongs to the device: one that it sends, or one that is sent to it alone.
/// Devices with 29-bit identifiers, or with commands, have a `concerns` of their own.
template <class Device>
[[nodiscard]] constexpr bool concerns(const Device& device, const Frame& frame) noexcept {
    if constexpr (requires { device.concerns(frame); }) {
        return device.concerns(frame);
    } else {
        return !frame.extended && device.claims(frame.id);
    }
}

/// Result for frame number `part` of a wrench.
[[nodiscard]] constexpr Decoded wrench_part(int part) noexcept {
    Decoded decoded;
    decoded.kind = Decoded::Kind::part;
    decoded.part = part;
    return decoded;
}

/// Returns a classic data frame of zeros.
[[nodiscard]] constexpr Frame make_frame(std::uint32_t id, int length) noexcept {
    Frame frame;
    frame.id = id;
    frame.length = static_cast<std::uint8_t>(length);
    return frame;
}

} // namespace dfdyn::hal
