// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/recording/recording.hpp"
#include "tools/robot/robot.hpp"
#include "tools/setup_check/setup_finding.hpp"

#include <span>
#include <vector>

namespace dfdyn::tools {

/// What is wrong with the recordings before a model is trained on them, each text with the file's name in
/// front. `robot`: null for a model without one; then only what the recordings alone show.
/// `torque_constants`: given for currents, N·m/A; empty: unknown. Not looked at: whether the recording is
/// long enough, or the arm moves. Cost: a second for an arm of six joints.
SetupFindings check_setup(std::span<const Recording> recordings, OutputKind outputs, const Robot* robot,
                          const std::vector<double>& torque_constants);

/// Throws InputError with the first mistake among the findings.
void refuse_mistakes(const SetupFindings& findings);

} // namespace dfdyn::tools
