// SPDX-License-Identifier: Apache-2.0
#include "tools/can/description/dbc_fields.hpp"

#include "tools/base/text/text.hpp"
#include "tools/can/families/family_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace dfdyn::tools {

namespace {

using Names = std::vector<std::string_view>;

double radians_per(const JsonReader& field) {
    static constexpr std::array<std::pair<std::string_view, double>, 3> units{
        {{"rad", 1}, {"deg", std::numbers::pi / 180}, {"turn", 2 * std::numbers::pi}}};
    const std::string unit = field.has("unit") ? field.text("unit") : "rad";
    for (const auto& [name, radians] : units) {
        if (name == unit) {
            return radians;
        }
    }
    throw field.error("unit", "rad, deg or turn", in_quotes(unit));
}

std::optional<hal::Range> limits_of(const DbcSignal& signal, double scale, double offset) {
    if (signal.lowest == 0 && signal.highest == 0) {
        return std::nullopt;
    }
    const double one = scale * signal.lowest + offset;
    const double other = scale * signal.highest + offset;
    // tolerance for an end that the factor does not reach exactly
    const double slack = 1e-9 * std::abs(one - other);
    return hal::Range{std::min(one, other) - slack, std::max(one, other) + slack};
}

const DbcMessage& message_of(const JsonReader& field, const Dbc& dbc) {
    const std::string name = field.text("message");
    const DbcMessage* const message = dbc.find(name);
    if (message == nullptr) {
        throw field.error("message", "a message of the DBC file", in_quotes(name));
    }
    if (!hal::is_frame_length(static_cast<std::uint32_t>(message->length), message->length > 8)) {
        throw field.error("message", "one of a length that a frame can have",
                          std::to_string(message->length) + " bytes");
    }
    return *message;
}

const DbcSignal& signal_of(const JsonReader& field, const DbcMessage& message) {
    const std::string name = field.text("signal");
    const DbcSignal* const signal = message.find(name);
    if (signal == nullptr) {
        throw field.error("signal", "a signal of " + message.name, in_quotes(name));
    }
    return *signal;
}

/// Conditions for the presence of a signal in its message, from its own multiplexor to the outermost one.
std::vector<DbcCondition> conditions_of(const JsonReader& field, const DbcMessage& message,
                                        const DbcSignal& signal) {
    std::vector<DbcCondition> conditions;
    const DbcSignal* current = &signal;
    while (current->multiplex || !current->multiplexed_by.empty()) {
        const DbcSignal* const multiplexor = message.multiplexor_of(*current);
        if (multiplexor == nullptr || conditions.size() == message.signals.size()) {
            throw field.error("signal",
                              "a signal whose multiplexor is known: the only one of its message, or the one "
                              "that SG_MUL_VAL_ names",
                              in_quotes(current->name) + " of " + message.name);
        }
        conditions.push_back({multiplexor->signal, current->multiplex_ranges});
        if (conditions.back().ranges.empty()) {
            conditions.back().ranges.push_back({*current->multiplex, *current->multiplex});
        }
        current = multiplexor;
    }
    return conditions;
}

/// `{"message": "Drive1", "signal": "Position", "scale": 1, "offset": 0}`: the value in the unit of the arm
/// is unit · (scale · value in the DBC file's unit + offset).
DbcField read_field(const JsonReader& field, const Dbc& dbc, double unit) {
    const DbcMessage& message = message_of(field, dbc);
    const DbcSignal& signal = signal_of(field, message);
    const double scale = unit * field.number_or("scale", 1, -1e12, 1e12);
    const double offset = unit * field.number_or("offset", 0, -1e12, 1e12);
    if (scale == 0) {
        throw field.error("scale", "a number that is not 0", "0");
    }
    DbcField result{message.id,
                    message.extended,
                    message.length,
                    signal.signal,
                    limits_of(signal, scale, offset),
                    conditions_of(field, message, signal)};
    result.signal.factor *= scale;
    result.signal.offset = result.signal.offset * scale + offset;
    return result;
}

bool same_bits(const DbcField& one, const DbcField& other) {
    return one.shares_frames_with(other) && one.signal.start_bit == other.signal.start_bit;
}

/// Returns true if `test` holds for a field of any of the joints.
template <class Test>
bool any_field(std::span<const DbcJoint> joints, Test test) {
    return std::ranges::any_of(joints, [&](const DbcJoint& joint) {
        return test(joint.config().position) || (joint.config().effort && test(*joint.config().effort));
    });
}

/// Reads a field of a joint that no other joint uses.
DbcField read_own_field(const JsonReader& board, const std::string& name, const Dbc& dbc, bool angle,
                        std::span<const DbcJoint> before) {
    const JsonReader reader = board.object(name);
    Names names{"message", "signal", "scale", "offset"};
    if (angle) {
        names.insert(names.end(), {"unit", "count_rad"});
    }
    reader.allow_only(names);
    DbcField field = read_field(reader, dbc, angle ? radians_per(reader) : 1);
    if (any_field(before, [&](const DbcField& other) { return same_bits(field, other); })) {
        throw reader.error("signal", "one that no other joint has", in_quotes(reader.text("signal")));
    }
    return field;
}

} // namespace

DbcJoint read_dbc_joint(const JsonReader& board, const Dbc& dbc, std::span<const DbcJoint> before) {
    board.allow_only(Names{"joint", "position", "effort"});
    DbcJoint::Config config;
    config.joint = read_joint(board);
    config.position = read_own_field(board, "position", dbc, true, before);
    config.count_rad = board.object("position").number_or("count_rad", 0, 1e-9, 0.1);
    if (board.has("effort")) {
        config.effort = read_own_field(board, "effort", dbc, false, before);
    }
    const auto claimed = [&](const DbcField& field) {
        return any_field(before, [&](const DbcField& other) {
            return other.id == field.id && other.extended == field.extended;
        });
    };
    config.claims_position = !claimed(config.position);
    config.claims_effort = config.effort && !claimed(*config.effort);
    return DbcJoint(config);
}

DbcSensor read_dbc_sensor(const JsonReader& output, const Dbc& dbc) {
    std::array<DbcField, 6> fields;
    const std::vector<JsonReader> entries = output.objects("wrench", 6, 6);
    for (std::size_t i = 0; i < fields.size(); ++i) {
        entries[i].allow_only(Names{"message", "signal", "scale", "offset"});
        fields[i] = read_field(entries[i], dbc, 1);
        for (std::size_t other = 0; other < i; ++other) {
            if (same_bits(fields[i], fields[other])) {
                throw entries[i].error("signal", "another one than for the other axes",
                                       in_quotes(entries[i].text("signal")));
            }
        }
    }
    if (!DbcSensor::can_be(fields)) {
        throw output.error("wrench", "signals in two frames: two messages, or two variants of one",
                           "another number of frames");
    }
    return DbcSensor(fields);
}

} // namespace dfdyn::tools
