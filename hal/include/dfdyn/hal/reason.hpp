// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dfdyn::hal {

/// Why there is no sample, no output in it, or why a frame was refused; apart from the learner's own
/// `dfdyn::Reason`. Below 32: limits, nothing is wrong. From 32: faults. The numbers are stable.
enum class Reason : std::uint8_t {
    ok = 0,

    /// A joint has not reported its position yet. Cure: wait; check the joint's identifier if it lasts.
    waiting_for_position = 1,
    /// The sensor has not reported yet. Cure: wait; start its transmission; check its identifiers if it
    /// lasts.
    waiting_for_output = 2,
    /// A source that has just come up (or back) has not shown enough readings that are not zero. Cure: wait;
    /// a joint that stands exactly at zero is believed after a longer while, or once it moves.
    qualifying = 3,
    /// The sensor's full scale, or calibration, is not known yet. Cure: request it (see the decoder).
    waiting_for_full_scale = 4,
    /// The instant asked for is older than what the history holds. Cure: a shorter delay or a longer history.
    history_too_short = 5,
    /// Nothing was measured since the last valid output: predict only. Normal where the sensor is slower than
    /// the tick.
    output_not_new = 6,
    /// No such output: the arm is assembled without one, or its drives do not send it.
    no_output = 7,

    /// A joint fell silent: its last position is older than its limit. Cure: check the board and its cable.
    position_stale = 32,
    /// The sensor fell silent. Cure: check the sensor and its cable.
    output_stale = 33,
    /// Positions are missing about the instant asked for: frames were lost.
    position_gap = 34,
    /// Outputs are missing about the instant asked for: frames were lost.
    output_gap = 35,
    /// One of the frames that make up a wrench was lost, or came too far from the other.
    output_incomplete = 36,
    /// The sensor is overloaded or its converter at its end; the values are not those of the moment.
    output_saturated = 37,
    /// The sensor repeats the very same raw values: it is stuck, whatever its time stamps. Cure: restart it.
    output_frozen = 38,
    /// A position is beyond its joint's range, or not a number. Cure: check scale and zero of the encoder.
    position_out_of_range = 39,
    /// An output is beyond the sensor's range, or not a number. Cure: check its full scale and calibration.
    output_out_of_range = 40,
    /// The full scale that the sensor reported, or the calibration given, cannot be: 0, a default, not a
    /// number.
    full_scale_implausible = 41,
    /// The device itself says that its encoder is in error.
    encoder_fault = 42,
    /// The device itself reports a fault. Cure: read its error code; clear the fault.
    device_fault = 43,
    /// The device is not in its operational state. Cure: start the node.
    device_not_operational = 44,
    /// The device's heartbeat is missing, which must say that the values are good. Cure: enable it.
    heartbeat_missing = 45,
    /// Stamps ran backward, or ahead of the bus' clock; a new clock is adopted after a while of consistency.
    clock_jumped = 46,
    /// The stamp is not later than the last of its source: a frame that was overtaken or repeated. Or the
    /// instant asked for is not later than the last sample's.
    time_not_increasing = 47,
    /// The operating system or the controller dropped frames. Cure: read more often; a larger buffer.
    frames_lost = 48,
    /// The controller is bus-off. Cure: find the fault on the bus; let it restart (restart-ms).
    bus_off = 49,
    /// The interface is down or gone.
    interface_down = 50,
    /// A frame with one of our identifiers has another length than the message. Cure: check the mapping.
    wrong_length = 51,
    /// A frame with one of our identifiers is a remote request or CAN FD.
    wrong_frame_type = 52,
    /// Frames of one identifier come faster than one device sends them: two devices share it. Cure: give one
    /// of them another.
    id_collision = 53,
};

/// One past the largest number of a reason; sizes tables indexed by it.
inline constexpr int reason_count = 54;

/// The reason's name as written in reports and logs ("ok" for none).
constexpr const char* name(Reason reason) noexcept {
    switch (reason) {
    case Reason::ok:
        return "ok";
    case Reason::waiting_for_position:
        return "waiting_for_position";
    case Reason::waiting_for_output:
        return "waiting_for_output";
    case Reason::qualifying:
        return "qualifying";
    case Reason::waiting_for_full_scale:
        return "waiting_for_full_scale";
    case Reason::history_too_short:
        return "history_too_short";
    case Reason::output_not_new:
        return "output_not_new";
    case Reason::no_output:
        return "no_output";
    case Reason::position_stale:
        return "position_stale";
    case Reason::output_stale:
        return "output_stale";
    case Reason::position_gap:
        return "position_gap";
    case Reason::output_gap:
        return "output_gap";
    case Reason::output_incomplete:
        return "output_incomplete";
    case Reason::output_saturated:
        return "output_saturated";
    case Reason::output_frozen:
        return "output_frozen";
    case Reason::position_out_of_range:
        return "position_out_of_range";
    case Reason::output_out_of_range:
        return "output_out_of_range";
    case Reason::full_scale_implausible:
        return "full_scale_implausible";
    case Reason::encoder_fault:
        return "encoder_fault";
    case Reason::device_fault:
        return "device_fault";
    case Reason::device_not_operational:
        return "device_not_operational";
    case Reason::heartbeat_missing:
        return "heartbeat_missing";
    case Reason::clock_jumped:
        return "clock_jumped";
    case Reason::time_not_increasing:
        return "time_not_increasing";
    case Reason::frames_lost:
        return "frames_lost";
    case Reason::bus_off:
        return "bus_off";
    case Reason::interface_down:
        return "interface_down";
    case Reason::wrong_length:
        return "wrong_length";
    case Reason::wrong_frame_type:
        return "wrong_frame_type";
    case Reason::id_collision:
        return "id_collision";
    }
    return "unknown";
}

constexpr bool is_fault(Reason reason) noexcept { return static_cast<std::uint8_t>(reason) >= 32; }

} // namespace dfdyn::hal
