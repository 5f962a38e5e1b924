// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/signals.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Reasons why a recording with a correct set-up is unsuitable: too little motion, another robot, too short a
/// time. Mistakes in the set-up: tools/setup_check. One sentence each, the most serious first.
struct Suspicions {
    std::vector<std::string> sentences;
    bool fatal = false; ///< findings would not be credible
};

/// Checks the file, before the motion is computed.
Suspicions suspicions_of_file(const Recording& recording);

/// Checks the motion and the rigid body's outputs along it. `measured`: T x m, as torques.
Suspicions suspicions_of_motion(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured);

} // namespace dfdyn::tools
