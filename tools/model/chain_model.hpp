// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/model/model.hpp"
#include "tools/robot/robot.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Returns the robot's geometry as stored in a model. For a wrench it includes the robot's sensor; throws
/// InputError if the robot has none.
ChainModel chain_model(const Robot& robot, OutputKind outputs);

/// Returns the columns of the named effects: one for each joint, or one for each axis for `ft_bias`. The
/// shape constants are `sign_velocity` and 5 times that. Throws InputError for an effect that is unknown,
/// named twice, or impossible for the outputs.
std::vector<EffectModel> effect_models(const std::vector<std::string>& names, const ChainModel& chain,
                                       double sign_velocity);

/// Returns the names and units of all columns of the physics: `link2 mcx (kg·m)`, `joint1 viscous
/// (N·m·s/rad)`.
std::vector<std::string> column_names(const Robot& robot, const ChainModel& chain,
                                      const std::vector<EffectModel>& effects);

} // namespace dfdyn::tools
