// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Returns the unit at a joint of a quantity whose unit at a revolute joint is `unit`: N·m becomes N at a
/// prismatic joint, rad becomes m, kg·m² becomes kg.
std::string unit_at_joint(const std::string& unit, bool prismatic);

/// Sets the units of the outputs.
void set_output_units(Diagnosis& diagnosis, const Robot& robot, OutputKind outputs);

/// Gives the parameters at prismatic joints their units: findings and nuisance parameters at `jointK`,
/// `encoderK` or `actuatorK`.
void use_units_of_joints(Diagnosis& diagnosis, const Robot& robot);

} // namespace dfdyn::tools
