// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/inertia.hpp"

namespace dfdyn::tools {

/// Coordinates without bounds of a physically consistent body: its pseudo-inertia is U Uᵀ with U = e^α [e^d1
/// s12 s13 t1; 0 e^d2 s23 t2; 0 0 e^d3 t3; 0 0 0 1] (Rucker and Wensing 2022). In order: α, d1, d2, d3, s12,
/// s23, s13, t1, t2, t3. Mass is e^2α kg, t the centre of mass in m; e^d and s are in m.
using LogCholesky = Eigen::Matrix<double, 10, 1>;

InertialParameters parameters_from(const LogCholesky& coordinates);

/// Returns the derivatives of `parameters_from`: column j with respect to coordinate j.
Eigen::Matrix<double, 10, 10> parameters_slope(const LogCholesky& coordinates);

/// Returns the inverse of `parameters_from`; the pseudo-inertia must be positive definite.
LogCholesky coordinates_of(const InertialParameters& parameters);

/// Returns whether a body with volume can have these parameters: positive definite pseudo-inertia.
bool is_consistent(const InertialParameters& parameters);

/// Returns the parameters if they are consistent, otherwise similar ones with a mass of at least `least_mass`
/// and principal second moments of at least mass · (1 mm)².
InertialParameters made_consistent(const InertialParameters& parameters, double least_mass);

} // namespace dfdyn::tools
