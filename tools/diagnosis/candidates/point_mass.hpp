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

/// Returns shapes of these columns of `mass_columns`, without rules: the `wanted` ones, each without columns
/// that the motion does not determine. These are almost zero, such as those of a centre of mass along the
/// common direction of all axes, or combinations of the shape's other columns. A shape with a single column
/// remains. A shape that lacks columns is left out if its other columns describe the same as an earlier
/// shape, or if they are a mass and its centre that act on a single output.
std::vector<EffectShape> determined_shapes(const std::vector<EffectColumn>& columns,
                                           const std::vector<std::vector<std::size_t>>& wanted);

/// A change of a mass (kg) and of its first moments (kg·m).
struct MassChange {
    double mass = 0;
    Eigen::Vector3d moments = Eigen::Vector3d::Zero();
};

/// Returns the change by the coefficients of a shape of `mass_columns`. Columns 0 to 3 can be repeated, for
/// several times of an event. What the shape lacks is zero.
MassChange mass_change(const Eigen::VectorXd& coefficients, const EffectShape& shape);

/// Returns whether the shape has a column of the first moment along an axis (0 to 2).
bool has_moment(const EffectShape& shape, std::size_t axis);

} // namespace dfdyn::tools
