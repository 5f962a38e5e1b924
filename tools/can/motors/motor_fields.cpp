// SPDX-License-Identifier: Apache-2.0
#include "tools/can/motors/motor_fields.hpp"

#include "tools/base/text/text.hpp"

namespace dfdyn::tools {

namespace {

/// Returns the type that `motor` names; null without the field.
const MotorType* read_motor_type(const JsonReader& board, std::span<const MotorType> types) {
    if (!board.has("motor")) {
        return nullptr;
    }
    const std::string name = board.text("motor");
    const auto type = std::ranges::find(types, name, &MotorType::name);
    if (type == types.end()) {
        std::vector<std::string> names;
        std::ranges::transform(types, std::back_inserter(names),
                               [](const MotorType& known) { return std::string(known.name); });
        throw board.error("motor", "one of " + listed(names), in_quotes(name));
    }
    return &*type;
}

} // namespace

Maxima read_maxima(const JsonReader& board, std::span<const MotorType> types,
                   const std::array<std::string, 3>& expected) {
    const MotorType* const type = read_motor_type(board, types);
    Maxima maxima{};
    for (std::size_t i = 0; i < maxima.size(); ++i) {
        const std::string name = maximum_names[i];
        if (board.has(name)) {
            maxima[i] = board.positive_number(name);
        } else if (type != nullptr && type->agrees(i)) {
            maxima[i] = type->maxima[i];
        } else {
            throw board.error(name, expected[i] + ", for which no default is sure", "none");
        }
    }
    return maxima;
}

double read_torque_constant(const JsonReader& board) {
    return board.has("newton_metre_per_ampere") ? board.positive_number("newton_metre_per_ampere") : 0;
}

FamilyField transmission_field() { return {"motor_per_joint", "(1)"}; }

FamilyField zero_field() {
    return {"zero_rad", "(0): angle = motor / motor_per_joint + zero, torque = motor · motor_per_joint"};
}

} // namespace dfdyn::tools
