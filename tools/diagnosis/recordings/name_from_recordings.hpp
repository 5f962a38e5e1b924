// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/recordings/several_recordings.hpp"

namespace dfdyn::tools {

/// Adds the findings of the pooled fit to the diagnosis of the joined recording (without loads):
/// - the load of all recordings, or of each one with a load;
/// - friction, rotor inertia and offset at the joints: the common value, the value in each, and an interval
///   with the spread between them. Where the gears are real ones (`friction_everywhere`), they replace the
///   causes there, and only links and loads that all recordings together support are named. Elsewhere the
///   joined recording decides the names;
/// - a confidence below 0.5 for other causes that the recordings contradict (`doubt_contradicted_findings`).
///
/// Adds the names of the recordings to the diagnosis. Cost: O(T (10 n)²).
void name_from_recordings(DiagnosisWork& work, const Robot& robot, const SeveralRecordings& several,
                          const std::vector<Recording>& recordings);

} // namespace dfdyn::tools
