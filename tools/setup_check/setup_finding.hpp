// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// What can be wrong with the set-up behind a recording.
enum class SetupFault {
    time_unit,
    position_unit,
    wrapped_position,
    dead_output,
    output_unit,
    joint_order,
    torque_sign,
    gravity,
};

enum class Severity {
    warning, ///< likely; a right recording of an unusual arm could show it, too
    mistake, ///< the evidence is overwhelming
};

struct SetupFinding {
    SetupFault fault;
    Severity severity;
    std::string text; ///< one line: column, what was expected, what was found, what to do
};

using SetupFindings = std::vector<SetupFinding>;

inline bool any_mistake(const SetupFindings& findings) {
    return std::ranges::any_of(
        findings, [](const SetupFinding& finding) { return finding.severity == Severity::mistake; });
}

} // namespace dfdyn::tools
