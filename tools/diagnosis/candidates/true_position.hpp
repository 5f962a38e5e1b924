// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/signals.hpp"

namespace dfdyn::tools {

/// Returns the rigid body's outputs (T x m) along the measured motion, with the position of `joint` changed
/// by `change` (T, rad).
Eigen::MatrixXd outputs_with_position(const DiagnosisSignals& signals, std::size_t joint,
                                      const Eigen::VectorXd& change);

/// Returns a change (T) of the position of `joint`, low-pass filtered at `share` of the cutoff of its
/// measured position, so that accelerations can be computed from it.
Eigen::VectorXd smooth_change(const DiagnosisSignals& signals, std::size_t joint,
                              const Eigen::VectorXd& change, double share);

} // namespace dfdyn::tools
