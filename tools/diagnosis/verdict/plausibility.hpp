// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

#include <vector>

namespace dfdyn::tools {

// Reasons why a recording with a correct set-up is unsuitable: too little motion, another robot, too short.
// Mistakes in the set-up: tools/setup_check. The most serious reason is the first.

/// Returns whether the rows are 20 µs to 0.2 s apart (median); false for fewer than two rows.
bool usable_rate(const Recording& recording);

/// Checks the file, before the motion is computed.
std::vector<Suspicion> suspicions_of_file(const Recording& recording);

/// Checks the motion and the rigid body's outputs along it. `measured`: T x m, as torques.
std::vector<Suspicion> suspicions_of_motion(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                                            const Recording& recording);

} // namespace dfdyn::tools
