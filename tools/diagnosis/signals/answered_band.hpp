// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/signals.hpp"

namespace dfdyn::tools {

/// m, Hz: up to which frequency a joint's output answers to the motion of its positions. What the positions
/// show above, the rigid body's torque of which is not in the output, is none of the motor's: a link that
/// swings on its gear, positions that were read at other instants than their stamps say. An output that lags
/// does answer. Twice the highest frequency that is analysed where nothing speaks against it; for a wrench
/// everywhere. Cost: three transforms per output.
Eigen::VectorXd answered_hz(const DiagnosisSignals& signals);

} // namespace dfdyn::tools
