// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Returns the estimated nuisance parameters of a fit: every joint's torque constant if it was not
/// given, and every link's mass if masses are uncertain. `torque_gains`: A per N·m with which the
/// fit's torques were computed.
std::vector<NuisanceEstimate> estimate_nuisances(const DiagnosisSignals& signals,
                                                 const FittedEffects& fitted_effects,
                                                 const Eigen::VectorXd& torque_gains);

} // namespace dfdyn::tools
