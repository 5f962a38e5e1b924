// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Possible fault of the set-up of a recording.
enum class SetupFault {
    time_unit,
    position_unit,
    wrapped_position,
    quantised_position,
    dead_output,
    saturated_output,
    output_unit,
    clock,
    joint_order,
    torque_sign,
    wrong_robot,
    gravity,
};

/// Name of a fault, as in `refusals` of diagnosis.json.
constexpr std::string_view name_of(SetupFault fault) {
    switch (fault) {
    case SetupFault::time_unit:
        return "time_unit";
    case SetupFault::position_unit:
        return "position_unit";
    case SetupFault::wrapped_position:
        return "wrapped_position";
    case SetupFault::quantised_position:
        return "quantised_position";
    case SetupFault::dead_output:
        return "dead_output";
    case SetupFault::saturated_output:
        return "saturated_output";
    case SetupFault::output_unit:
        return "output_unit";
    case SetupFault::clock:
        return "clock";
    case SetupFault::joint_order:
        return "joint_order";
    case SetupFault::torque_sign:
        return "torque_sign";
    case SetupFault::wrong_robot:
        return "wrong_robot";
    case SetupFault::gravity:
        break;
    }
    return "gravity";
}

enum class Severity {
    warning, ///< likely; also possible for a correct recording of an unusual arm
    mistake, ///< overwhelming evidence
};

struct SetupFinding {
    SetupFault fault;
    Severity severity;
    std::string columns; ///< names of the columns concerned, separated by commas
    std::string text;    ///< one line: column, expected, found, remedy
};

using SetupFindings = std::vector<SetupFinding>;

inline bool any_mistake(const SetupFindings& findings) {
    return std::ranges::any_of(
        findings, [](const SetupFinding& finding) { return finding.severity == Severity::mistake; });
}

} // namespace dfdyn::tools
