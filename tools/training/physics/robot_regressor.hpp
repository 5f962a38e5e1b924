// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/training/physics/regressor.hpp"

#include <memory>

namespace dfdyn::tools {

/// Returns the firmware's columns in double: ten per body of `chain`, then `effects`, converted to output
/// units by `output_gain`. Thread-safe.
std::unique_ptr<Regressor> robot_regressor(const ChainModel& chain, const std::vector<EffectModel>& effects,
                                           const std::vector<double>& output_gain);

} // namespace dfdyn::tools
