// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Why a recording cannot answer which effects are there: positions or outputs in another unit, a clock in
/// milliseconds, columns exchanged, another robot, an arm that hardly moves, too short a time. A sentence
/// each, the gravest first; none of them when the recording may be asked. `measured`: T x m as recorded;
/// `gains_known` as of the candidates.
struct Suspicions {
    std::vector<std::string> sentences;
    bool fatal = false; ///< what would be named is not to be believed
};

/// Of what the file holds, before any motion is made of it.
Suspicions suspicions_of_file(const Robot& robot, const Recording& recording);

/// Of the motion and the rigid body's outputs along it.
Suspicions suspicions_of_motion(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                                bool gains_known);

} // namespace dfdyn::tools
