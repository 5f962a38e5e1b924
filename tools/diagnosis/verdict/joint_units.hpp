// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Returns the unit of a torque at output number `output`.
std::string torque_unit(const Robot& robot, bool wrench, std::size_t output);

/// Sets the units of the outputs.
void set_output_units(Diagnosis& diagnosis, const Robot& robot, OutputKind outputs);

/// Gives the parameters at prismatic joints their units: findings and nuisance parameters at `jointK`,
/// `encoderK` or `actuatorK`.
void use_units_of_joints(Diagnosis& diagnosis, const Robot& robot);

} // namespace dfdyn::tools
