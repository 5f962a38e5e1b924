// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/signals/signals.hpp"

#include <vector>

namespace dfdyn::tools {

/// Returns the unnamed candidates: dependences of each output on each joint's position or velocity, and of a
/// joint's friction on its position. Their size is at most the size of `unexplained` (T x m), the residual of
/// the rigid body. A larger one would only cancel a named candidate.
std::vector<Candidate> dependence_candidates(const DiagnosisSignals& signals,
                                             const Eigen::MatrixXd& unexplained);

} // namespace dfdyn::tools
