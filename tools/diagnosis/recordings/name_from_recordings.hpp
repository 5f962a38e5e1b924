// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/recordings/several_recordings.hpp"

namespace dfdyn::tools {

/// Names what several recordings say together, after the diagnosis of their joined recording (without loads):
/// - the load of all recordings, or of each that has one;
/// - friction, rotor inertia and offset at the joints: one value for all recordings, the value in each, and
///   an interval with the spread between them. Where the gears are real ones (`friction_everywhere`) these
///   are all causes there, and only links and loads that all recordings together support are named.
///   Elsewhere the diagnosis of the joined recording decides the names;
/// - a confidence below 0.5 for another cause that the recordings contradict: the sizes that they give to it
///   have a mean within two standard deviations of zero (R. DerSimonian and N. Laird, 1986).
///
/// Adds the names of the recordings to the diagnosis. Cost: O(T (10 n)²).
void name_from_recordings(DiagnosisWork& work, const Robot& robot, const SeveralRecordings& several,
                          const std::vector<Recording>& recordings);

} // namespace dfdyn::tools
