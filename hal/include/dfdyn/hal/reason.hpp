// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dfdyn::hal {

/// Reason why there is no sample, why a sample has no output, or why a frame was rejected. It is distinct
/// from the learner's `dfdyn::Reason`. Numbers below 32 are limitations, numbers from 32 are faults. The
/// numbers are stable.
enum class Reason : std::uint8_t {
    ok = 0,

    /// A joint has not reported its position yet. Remedy: wait; if it persists, check the joint's identifier.
    waiting_for_position = 1,
    /// The sensor has not reported yet. Remedy: wait; start its transmission; check its identifiers if it
    /// persists.
    waiting_for_output = 2,
    /// A source that has just started or returned has not yet sent enough nonzero readings. Remedy: wait. A
    /// joint that is stationary at exactly zero is accepted after a longer time, or once it moves.
    qualifying = 3,
    /// The full scale or the calibration of the sensor is not known yet. Remedy: request it (see the
    /// decoder).
    waiting_for_full_scale = 4,
    /// The requested sample time is older than the stored history. Remedy: a shorter delay or a longer
    /// history.
    history_too_short = 5,
    /// No measurement has arrived since the last valid output, so only a prediction is possible. This is
    /// normal if the sensor is slower than the tick.
    output_not_new = 6,
    /// There is no such output: the arm is assembled without one, or its drives do not send it.
    no_output = 7,

    /// A joint has stopped sending: its last position is older than its limit. Remedy: check the board and
    /// its cable.
    position_stale = 32,
    /// The sensor has stopped sending. Remedy: check the sensor and its cable.
    output_stale = 33,
    /// Positions around the requested sample time are missing: frames were lost.
    position_gap = 34,
    /// Outputs around the requested sample time are missing: frames were lost.
    output_gap = 35,
    /// One of the two frames of a wrench was lost, or they arrived too far apart.
    output_incomplete = 36,
    /// The sensor is overloaded or its converter is saturated; its values are not the present ones.
    output_saturated = 37,
    /// The sensor repeats identical raw values although its time stamps advance, so it is stuck. Remedy:
    /// restart it.
    output_frozen = 38,
    /// A position is beyond its joint's range or not a number. Remedy: check scale and zero of the encoder.
    position_out_of_range = 39,
    /// An output is beyond the sensor's range or not a number. Remedy: check its full scale and calibration.
    output_out_of_range = 40,
    /// The full scale reported by the sensor, or the configured calibration, is impossible: 0, a factory
    /// default, or not a number.
    full_scale_implausible = 41,
    /// The device reports an encoder error. Ends when it reports none.
    encoder_fault = 42,
    /// The device reports a fault. Ends when it reports none. Remedy: read its error code and clear the
    /// fault.
    device_fault = 43,
    /// The device is not in its operational state. Ends with a heartbeat that reports this state. Without a
    /// heartbeat_timeout_s it also ends after 3 s without a heartbeat; a boot-up ends with the next values.
    /// Remedy: start the node.
    device_not_operational = 44,
    /// The device's heartbeat, which must confirm that the values are good, is missing. Remedy: enable it.
    heartbeat_missing = 45,
    /// Time stamps ran backward, or ahead of the clock of the bus. A new clock is accepted after it has been
    /// consistent for a while.
    clock_jumped = 46,
    /// The time stamp is not later than the last one of its source: the frame was overtaken or repeated. Or
    /// the requested sample time is not later than that of the last sample.
    time_not_increasing = 47,
    /// The operating system or the controller dropped frames. Remedy: read more often, or use a larger
    /// buffer.
    frames_lost = 48,
    /// The controller is bus-off. Ends with its restart, or with the next frame that it receives. Remedy:
    /// find the fault on the bus; let the controller restart (restart-ms).
    bus_off = 49,
    /// The interface is down or removed.
    interface_down = 50,
    /// A frame with an identifier of a described device has the wrong length. Remedy: check the mapping.
    wrong_length = 51,
    /// A frame with an identifier of a described device is a remote request or CAN FD.
    wrong_frame_type = 52,
    /// Frames of one identifier arrive faster than one device sends them: two devices share it. Remedy: give
    /// one of them another identifier.
    id_collision = 53,

    /// The sensor reported a full scale that differs from the described or the previous one. Ends when it
    /// agrees with its description. Without a description it ends when all channels have been reported again.
    /// Remedy: request all of them; check which of its calibration sets is in use.
    full_scale_contradicted = 60,
    /// The device restarted between two values, so its zero may have moved. It must qualify again.
    device_restarted = 61,
    /// The position for this sample time was due and has not arrived: a frame was lost or is late. It is
    /// interpolated once the next one arrives. Remedy: lower the load; see the counters of lost frames.
    position_missing = 62,
    /// The output for this sample time was due and has not arrived: a frame was lost or is late.
    output_missing = 63,
    /// The joint cannot have reached this position since the last accepted one. Ends with the next position
    /// that it can have reached. Remedy, if real motions are rejected: joints.velocity_limit,
    /// acceleration_limit.
    position_jump = 64,
    /// After a jump or a restart the joint's positions continue from a different value: the encoder has lost
    /// its zero, or another device sends. Ends when they return to values that the joint can have. After a
    /// restart at the encoder's zero it ends with a new start only. Remedy: check the joint's position; set
    /// its zero; start again; joints.encoder, if the encoder is absolute. Also after a silence, while a
    /// wrapping integer has several turns within the joint's range. Remedy: start again; joints.limit_rad.
    position_lost = 65,
    /// A moving joint repeats its last position bit for bit and cannot have stopped. Ends when the position
    /// changes.
    position_frozen = 66,
    /// The answer to a SYNC arrived so late, or so early after a missing one, that it may belong to another
    /// SYNC. Ends with an answer at the usual time. Remedy: a lower load, or a longer SYNC period.
    sync_unknown = 67,
    /// The output differs from the last one by more than consecutive outputs do. Ends with the next output
    /// that agrees with its predecessor, or when several consecutive outputs agree with each other.
    output_jump = 68,
    /// The frame waited while nobody read the bus, so that the time of its values is unknown. Ends with the
    /// next frame in time. Remedy: read more often, with a higher priority.
    frame_waited = 69,
    /// The joint's positions contradict the velocity in the same frames, which agreed before: the encoder is
    /// frozen, or its scale, sign or zero changed. Ends when they agree over 0.05 rad. Remedy: check the
    /// encoder and the device's settings.
    velocity_contradicts = 70,
};

/// One more than the largest reason number; the size of tables that are indexed by a reason.
inline constexpr int reason_count = 71;

/// A reason and its name in messages and files.
struct NamedReason {
    Reason reason;    ///< the reason
    const char* name; ///< its name, such as "position_gap"
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
    {Reason::frame_waited, "frame_waited"},
    {Reason::velocity_contradicts, "velocity_contradicts"},
};

/// Returns the reason's name as written in reports and logs, "ok" for none. O(number of reasons).
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
