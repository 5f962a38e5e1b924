// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/signals/signals.hpp"
#include "tools/robot/inertia.hpp"

#include <vector>

namespace dfdyn::tools {

/// The span of candidates that add a point mass to the last link, such as a payload.
inline constexpr const char* last_body = "last body";

inline constexpr double farthest_payload = 0.5; ///< m, of a payload's centre of mass from the tip

/// Inertial parameters of a point mass (kg) at `centre` (m).
InertialParameters point_mass(double mass, const Eigen::Vector3d& centre);

/// Returns the columns of body `body` for a point mass at `centre` (per kg), then for its first moments about
/// it (per kg·m). Both are expressed in a frame at `placement` of the body. The moment of inertia is
/// quadratic in the displacement. It is exact without one and at `displacement` (m); its slope there is half
/// of the true one, so that repeated relinearization converges linearly.
std::vector<EffectColumn> mass_columns(const DiagnosisSignals& signals, Eigen::Index body,
                                       const Eigen::Vector3d& centre, const Eigen::Isometry3d& placement,
                                       const Eigen::Vector3d& displacement = Eigen::Vector3d::Zero());

} // namespace dfdyn::tools
