// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/signals.hpp"

namespace dfdyn::tools {

/// The rigid body's outputs along the measured motion, where the true position of `joint` is by `change` (T,
/// rad) another. T x m.
Eigen::MatrixXd outputs_with_position(const DiagnosisSignals& signals, std::size_t joint,
                                      const Eigen::VectorXd& change);

/// A change of the position of `joint` (T), low-passed at `share` of where its measured position was:
/// accelerations of it are to be taken.
Eigen::VectorXd smooth_change(const DiagnosisSignals& signals, std::size_t joint,
                              const Eigen::VectorXd& change, double share);

} // namespace dfdyn::tools
