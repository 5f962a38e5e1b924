// SPDX-License-Identifier: Apache-2.0
#include "tools/can/description/dbc_device.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double float_step = 1.2e-7; ///< relative resolution of a float

std::span<const std::uint8_t> data_of(const hal::Frame& frame) { return {frame.data.data(), frame.length}; }
std::span<std::uint8_t> data_of(hal::Frame& frame) { return {frame.data.data(), frame.length}; }

/// Returns true if a frame can carry the field: it has its message and, if there are several, its variant.
bool carries(const hal::Frame& frame, const DbcField& field) {
    return field.is_in(frame) && field.is_there(frame);
}

hal::Frame empty_frame(const DbcField& field) {
    hal::Frame frame = hal::make_frame(field.id, field.length);
    frame.extended = field.extended;
    frame.fd = field.length > 8;
    for (const DbcCondition& condition : field.conditions) {
        condition.multiplexor.insert_raw(data_of(frame), condition.ranges.front().first);
    }
    return frame;
}

bool claims(const DbcField& field, std::uint32_t id) { return !field.extended && field.id == id; }

/// Hashes the raw value, which may have any width, to 14 bits. The result changes with the value and is never
/// at an end of 16 bits, because this sensor detects saturation itself. 0 remains 0.
std::int32_t folded(std::uint64_t raw) {
    return static_cast<std::int32_t>((raw * 0x9E3779B97F4A7C15ULL) >> 50U);
}

} // namespace

bool DbcCondition::holds(const hal::Frame& frame) const noexcept {
    const std::uint64_t raw = multiplexor.extract_raw(data_of(frame));
    return std::ranges::any_of(
        ranges, [raw](const DbcValueRange& range) { return raw >= range.first && raw <= range.last; });
}

bool DbcCondition::excludes(const DbcCondition& other) const noexcept {
    const auto overlaps = [&](const DbcValueRange& mine) {
        return std::ranges::any_of(other.ranges, [&](const DbcValueRange& its) {
            return mine.first <= its.last && its.first <= mine.last;
        });
    };
    return multiplexor.start_bit == other.multiplexor.start_bit &&
           multiplexor.length == other.multiplexor.length &&
           multiplexor.byte_order == other.multiplexor.byte_order && std::ranges::none_of(ranges, overlaps);
}

bool DbcField::is_in(const hal::Frame& frame) const noexcept {
    return !frame.error && frame.extended == extended && frame.id == id;
}

hal::Reason DbcField::check(const hal::Frame& frame) const noexcept {
    if (frame.remote) {
        return hal::Reason::wrong_frame_type;
    }
    return frame.length == length ? hal::Reason::ok : hal::Reason::wrong_length;
}

bool DbcField::is_there(const hal::Frame& frame) const noexcept {
    return std::ranges::all_of(conditions,
                               [&](const DbcCondition& condition) { return condition.holds(frame); });
}

bool DbcField::shares_frames_with(const DbcField& other) const noexcept {
    const auto excluded = [&](const DbcCondition& mine) {
        return std::ranges::any_of(other.conditions,
                                   [&](const DbcCondition& its) { return mine.excludes(its); });
    };
    return id == other.id && extended == other.extended && std::ranges::none_of(conditions, excluded);
}

std::uint64_t DbcField::raw(const hal::Frame& frame) const noexcept {
    return signal.extract_raw(data_of(frame));
}

double DbcField::value(const hal::Frame& frame) const noexcept { return signal.extract(data_of(frame)); }

bool DbcField::is_void(double value) const noexcept {
    return !std::isfinite(value) || (limits && (value < limits->lowest || value > limits->highest));
}

bool DbcField::is_at_end(const hal::Frame& frame) const noexcept { return signal.is_at_end(data_of(frame)); }

std::size_t encode_fields(std::span<const DbcValue> values, std::span<hal::Frame> into) noexcept {
    std::size_t count = 0;
    // a signal that is in every variant needs no variant of its own
    for (const bool multiplexed : {true, false}) {
        for (const DbcValue& value : values) {
            const bool there = std::ranges::any_of(
                into.first(count), [&](const hal::Frame& frame) { return carries(frame, *value.field); });
            if (!value.field->conditions.empty() == multiplexed && !there && count < into.size()) {
                into[count] = empty_frame(*value.field);
                ++count;
            }
        }
    }
    for (const DbcValue& value : values) {
        for (hal::Frame& frame : into.first(count)) {
            if (carries(frame, *value.field)) {
                value.field->signal.insert(data_of(frame), value.value);
            }
        }
    }
    return count;
}

bool DbcJoint::claims(std::uint32_t id) const noexcept {
    return (config_.claims_position && tools::claims(config_.position, id)) ||
           (config_.effort && config_.claims_effort && tools::claims(*config_.effort, id));
}

hal::Decoded DbcJoint::decode(const hal::Frame& frame) const noexcept {
    const bool position = config_.position.is_in(frame);
    const bool effort = config_.effort && config_.effort->is_in(frame);
    if (!position && !effort) {
        return {};
    }
    const hal::Reason fault = position ? config_.position.check(frame) : config_.effort->check(frame);
    if (fault != hal::Reason::ok) {
        return hal::rejected(fault);
    }
    hal::Decoded decoded;
    decoded.kind = hal::Decoded::Kind::values;
    decoded.joints = 1;
    hal::JointValue& value = decoded.joint[0];
    value.joint = config_.joint;
    value.stamp_ns = frame.stamp_ns;
    if (position && config_.position.is_there(frame)) {
        value.position_rad = config_.position.value(frame);
        const hal::Signal& signal = config_.position.signal;
        value.from_zero_rad = value.position_rad - signal.offset;
        const double rounding =
            signal.step() > 0 ? signal.step() : float_step * std::abs(value.from_zero_rad);
        value.step_rad = std::max(config_.count_rad, rounding);
        value.wrap_rad = signal.span();
        value.raw_zero = config_.position.raw(frame) == 0;
        value.position_reason = config_.position.is_void(value.position_rad)
                                    ? hal::Reason::position_out_of_range
                                    : hal::Reason::ok;
    }
    if (effort && config_.effort->is_there(frame)) {
        value.effort = config_.effort->value(frame);
        // A magnitude of 0 is the lowest representable value, but not saturated.
        const bool saturated = config_.effort->is_at_end(frame) && value.effort != 0;
        value.effort_reason = config_.effort->is_void(value.effort) ? hal::Reason::output_out_of_range
                              : saturated                           ? hal::Reason::output_saturated
                                                                    : hal::Reason::ok;
    }
    return decoded;
}

hal::FrameList DbcJoint::encode(const std::array<hal::JointValue, 1>& values) const noexcept {
    std::array<DbcValue, 2> fields{DbcValue{&config_.position, values[0].position_rad}};
    std::size_t count = 1;
    if (config_.effort) {
        fields[count++] = {&*config_.effort, values[0].effort};
    }
    hal::FrameList frames;
    frames.count = static_cast<int>(encode_fields(std::span(fields).first(count), frames.frame));
    return frames;
}

DbcSensor::DbcSensor(std::array<DbcField, 6> fields) noexcept : fields_(std::move(fields)) {
    const auto other = std::ranges::find_if(
        fields_, [&](const DbcField& field) { return !field.shares_frames_with(fields_[0]); });
    second_ = other == fields_.end() ? fields_[0] : *other;
}

bool DbcSensor::can_be(const std::array<DbcField, 6>& fields) noexcept {
    const DbcSensor sensor(fields);
    return !sensor.second_.shares_frames_with(fields[0]) &&
           std::ranges::all_of(fields, [&](const DbcField& field) {
               return field.shares_frames_with(fields[0]) != field.shares_frames_with(sensor.second_);
           });
}

bool DbcSensor::claims(std::uint32_t id) const noexcept {
    return tools::claims(fields_[0], id) || tools::claims(second_, id);
}

bool DbcSensor::is_first(const hal::Frame& frame) const noexcept { return carries(frame, fields_[0]); }

hal::Decoded DbcSensor::decode(const hal::Frame& frame) const noexcept {
    const bool first = fields_[0].is_in(frame);
    if (!first && !second_.is_in(frame)) {
        return {};
    }
    const hal::Reason fault = first ? fields_[0].check(frame) : second_.check(frame);
    if (fault != hal::Reason::ok) {
        return hal::rejected(fault);
    }
    const bool part = is_first(frame) || carries(frame, second_);
    return part ? hal::wrench_part(is_first(frame) ? 0 : 1) : hal::Decoded{};
}

hal::WrenchReading DbcSensor::wrench(const hal::Frame& first, const hal::Frame& second) const noexcept {
    hal::WrenchReading reading;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
        const DbcField& field = fields_[i];
        const hal::Frame& frame = field.shares_frames_with(fields_[0]) ? first : second;
        reading.value[i] = field.value(frame);
        reading.raw[i] = folded(field.raw(frame));
        if (field.is_void(reading.value[i])) {
            reading.reason = hal::Reason::output_out_of_range;
        } else if (field.is_at_end(frame) && reading.reason == hal::Reason::ok) {
            reading.reason = hal::Reason::output_saturated;
        }
    }
    return reading;
}

hal::FrameList DbcSensor::encode(const hal::Wrench& value) const noexcept {
    std::array<DbcValue, 6> values;
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = {&fields_[i], value[i]};
    }
    hal::FrameList frames;
    frames.count = static_cast<int>(encode_fields(values, frames.frame));
    return frames;
}

} // namespace dfdyn::tools
