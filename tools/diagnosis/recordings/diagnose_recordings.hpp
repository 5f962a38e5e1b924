// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

#include <vector>

namespace dfdyn::tools {

/// Diagnoses recordings of one arm as one question, and shows the progress. Checks their set-ups, fits what
/// they have in common, diagnoses the joined recording, and names causes by both (`name_from_recordings`).
///
/// `loads_differ`: each recording can have a load of its own. The loads that are found in single recordings
/// are subtracted from the outputs in `recordings`, unless the set-up is refused. Throws InputError if fewer
/// than two recordings can then be compared, or as `diagnose` does. `options` need no `parts`, `setup`,
/// `progress` or `torque_gains`. Cost: that of `diagnose`, `fit_recordings` and `name_from_recordings`.
DiagnosisWork diagnose_recordings(const Robot& robot, std::vector<Recording>& recordings,
                                  DiagnosisOptions options, bool loads_differ);

} // namespace dfdyn::tools
