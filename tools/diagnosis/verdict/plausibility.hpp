// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/signals.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Why a recording of a right set-up cannot answer which effects are there: an arm that hardly moves, another
/// robot, too short a time. Mistakes in the set-up: tools/setup_check. A sentence each, the gravest first.
struct Suspicions {
    std::vector<std::string> sentences;
    bool fatal = false; ///< what would be named is not to be believed
};

/// What the file shows, before any motion is made of it.
Suspicions suspicions_of_file(const Recording& recording);

/// What the motion shows, and the rigid body's outputs along it. `measured`: T x m, as torques.
Suspicions suspicions_of_motion(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured);

} // namespace dfdyn::tools
