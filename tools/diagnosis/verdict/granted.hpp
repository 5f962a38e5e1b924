// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// What an explanation takes as it fits best without calling it a finding: every joint's torque constant
/// where it was not given, every link's mass where they are uncertain. `torque_gains`: ampere per N·m that
/// the explanation's own torques were made with.
std::vector<GrantedQuantity> granted_quantities(const DiagnosisSignals& signals,
                                                const Explanation& explanation,
                                                const Eigen::VectorXd& torque_gains);

} // namespace dfdyn::tools
