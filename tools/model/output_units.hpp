// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Returns the units of outputs with these names: A for currents; N for the forces of a wrench and for
/// prismatic joints; otherwise N·m. `chain`: of a model with physics; without one (nullptr) all joints count
/// as revolute.
std::vector<std::string> output_units(const std::vector<std::string>& names, const ChainModel* chain);

/// Does the same for the outputs of a model.
std::vector<std::string> output_units(const TrainedModel& model);

} // namespace dfdyn::tools
