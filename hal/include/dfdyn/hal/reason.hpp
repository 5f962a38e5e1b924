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
    /// The device itself says that its encoder is in error. Ends when it says otherwise.
    encoder_fault = 42,
    /// The device itself reports a fault. Ends when it reports none. Cure: read its error code; clear the
    /// fault.
    device_fault = 43,
    /// The device is not in its operational state. Ends with its heartbeat of that state, or where it sends
    /// none with the next values. Cure: start the node.
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
    /// The controller is bus-off. Ends with its restart, or with the next frame that it receives. Cure: find
    /// the fault on the bus; let it restart (restart-ms).
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

    /// The sensor reported another full scale than described, or than before. Ends when it agrees with its
    /// description, or without one when it has reported all channels again. Cure: ask for all of them; check
    /// which set of its calibration is in use.
    full_scale_contradicted = 60,
    /// The device restarted between two values: its zero may have moved. It must qualify again.
    device_restarted = 61,
    /// The position of this instant was due and has not come: a frame was lost or is late. It is interpolated
    /// once the next one comes. Cure: lower the load; see the counters of lost frames.
    position_missing = 62,
    /// The output of this instant was due and has not come; likewise.
    output_missing = 63,
    /// A position that the joint cannot have reached since the last one that was believed. Ends with the next
    /// one that it can have reached. Cure, where true motions are refused: joints.velocity_limit,
    /// acceleration_limit.
    position_jump = 64,
    /// After a jump or a restart the joint's positions go on from elsewhere: the encoder has lost its zero,
    /// or another device sends. Ends when they jump to where the joint can be. Cure: check the joint's
    /// position; set its zero; start again.
    position_lost = 65,
    /// A moving joint repeats its last position, bit for bit, and cannot have stopped. Ends when it changes.
    position_frozen = 66,
    /// The answer to a SYNC came so late, or so early after one was missing, that it may belong to another
    /// SYNC. Ends with an answer at the usual time. Cure: a lower load, or a longer period of the SYNC.
    sync_unknown = 67,
    /// An output that is further from the last one than outputs are that follow each other. Ends with the
    /// next that agrees with the one before, or when several in a row agree with each other.
    output_jump = 68,
};

/// One past the largest number of a reason; sizes tables indexed by it.
inline constexpr int reason_count = 69;

struct NamedReason {
    Reason reason;
    const char* name;
};

inline constexpr NamedReason reason_names[] = {
    {Reason::ok, "ok"},
    {Reason::waiting_for_position, "waiting_for_position"},
    {Reason::waiting_for_output, "waiting_for_output"},
    {Reason::qualifying, "qualifying"},
    {Reason::waiting_for_full_scale, "waiting_for_full_scale"},
    {Reason::history_too_short, "history_too_short"},
    {Reason::output_not_new, "output_not_new"},
    {Reason::no_output, "no_output"},
    {Reason::position_stale, "position_stale"},
    {Reason::output_stale, "output_stale"},
    {Reason::position_gap, "position_gap"},
    {Reason::output_gap, "output_gap"},
    {Reason::output_incomplete, "output_incomplete"},
    {Reason::output_saturated, "output_saturated"},
    {Reason::output_frozen, "output_frozen"},
    {Reason::position_out_of_range, "position_out_of_range"},
    {Reason::output_out_of_range, "output_out_of_range"},
    {Reason::full_scale_implausible, "full_scale_implausible"},
    {Reason::encoder_fault, "encoder_fault"},
    {Reason::device_fault, "device_fault"},
    {Reason::device_not_operational, "device_not_operational"},
    {Reason::heartbeat_missing, "heartbeat_missing"},
    {Reason::clock_jumped, "clock_jumped"},
    {Reason::time_not_increasing, "time_not_increasing"},
    {Reason::frames_lost, "frames_lost"},
    {Reason::bus_off, "bus_off"},
    {Reason::interface_down, "interface_down"},
    {Reason::wrong_length, "wrong_length"},
    {Reason::wrong_frame_type, "wrong_frame_type"},
    {Reason::id_collision, "id_collision"},
    {Reason::full_scale_contradicted, "full_scale_contradicted"},
    {Reason::device_restarted, "device_restarted"},
    {Reason::position_missing, "position_missing"},
    {Reason::output_missing, "output_missing"},
    {Reason::position_jump, "position_jump"},
    {Reason::position_lost, "position_lost"},
    {Reason::position_frozen, "position_frozen"},
    {Reason::sync_unknown, "sync_unknown"},
    {Reason::output_jump, "output_jump"},
};

/// The reason's name as written in reports and logs ("ok" for none). O(number of reasons).
constexpr const char* name(Reason reason) noexcept {
    for (const NamedReason& named : reason_names) {
        if (named.reason == reason) {
            return named.name;
        }
    }
    return "unknown";
}

constexpr bool is_fault(Reason reason) noexcept { return static_cast<std::uint8_t>(reason) >= 32; }

} // namespace dfdyn::hal
