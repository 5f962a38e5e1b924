// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// What can be wrong with a set-up or a recording; the first group are mistakes, the second recordings that
/// cannot answer which effects are there.
enum class SetupFault {
    position_unit,
    time_unit,
    output_unit,
    wrapped_position,
    dead_output,
    exchanged_columns,
    torque_sign,
    gravity_direction,

    wrong_robot,
    standstill,
    short_recording,
};

/// How much a finding weighs.
enum class Severity {
    note,         ///< worth a look
    unanswerable, ///< what a diagnosis would name from this recording is not to be believed
    mistake,      ///< the evidence is overwhelming: nothing that is made of the recording is of use
};

struct SetupFinding {
    SetupFault fault;
    Severity severity;
    std::string text; ///< one sentence: column, what was expected, what was found, what to do
};

using SetupFindings = std::vector<SetupFinding>;

inline bool any_of_severity(const SetupFindings& findings, Severity least) {
    return std::ranges::any_of(findings, [least](const SetupFinding& one) { return one.severity >= least; });
}

} // namespace dfdyn::tools
