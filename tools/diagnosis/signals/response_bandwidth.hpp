// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/signals.hpp"

namespace dfdyn::tools {

/// Returns the highest frequency (Hz, m) at which each measured torque is coherent with the rigid-body torque
/// computed from the encoder. Above it, the encoder measures motion that the motor does not cause, such as
/// vibration of the gear or the link, or position samples with wrong time stamps. A delayed response counts
/// as a response. The result is twice the highest analysed frequency if no limit is found, and always for a
/// wrench. Cost: three transforms per output.
Eigen::VectorXd response_bandwidth_hz(const DiagnosisSignals& signals);

} // namespace dfdyn::tools
