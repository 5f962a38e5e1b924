// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/signals/signals.hpp"
#include "tools/robot/inertia.hpp"

#include <vector>

namespace dfdyn::tools {

/// The span of candidates that add a point mass to the last link: a payload is part of it.
inline constexpr const char* last_body = "last body";

/// Point mass at `centre` (m), kg.
InertialParameters point_mass(double mass, const Eigen::Vector3d& centre);

/// Columns of body `body`: a point mass at `centre` (per kg), then its first moments about it (per kg·m);
/// seen in a frame at `placement` of the body.
std::vector<EffectColumn> mass_columns(const DiagnosisSignals& signals, Eigen::Index body,
                                       const Eigen::Vector3d& centre, const Eigen::Isometry3d& placement);

} // namespace dfdyn::tools
