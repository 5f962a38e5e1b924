// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"
#include "tools/robot/inertia.hpp"

#include <vector>

namespace dfdyn::tools {

/// Covariance of a body's ten inertial parameters.
using InertialCovariance = Eigen::Matrix<double, 10, 10>;

/// Returns mass and centre of mass of a body that changes by `change`, as differences from `nominal`, with
/// their intervals. They are the first four parameters of `effect`.
std::vector<FoundParameter> mass_and_centre(const Effect& effect, const InertialParameters& nominal,
                                            const InertialParameters& change,
                                            const InertialCovariance& covariance);

/// Returns effect and parameters of a link whose ten parameters are wrong: mass and centre of mass, or the
/// inertia about the centre, whichever deviates more from the robot's file (squared Mahalanobis distance
/// beyond noise).
Finding link_finding(const InertialParameters& nominal, const InertialParameters& change,
                     const InertialCovariance& covariance);

} // namespace dfdyn::tools
