// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/model/model.hpp"
#include "tools/robot/robot.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// The robot's geometry as a model stores it. Wrench: with the robot's sensor; throws InputError when it has
/// none.
ChainModel chain_model(const Robot& robot, OutputKind outputs);

/// A column for each joint (wrench: `ft_bias`, one for each axis) of every effect named; shape constants at
/// `sign_velocity` and 5 times that. Throws InputError for an effect that is unknown, named twice, or that
/// the outputs cannot show.
std::vector<EffectModel> effect_models(const std::vector<std::string>& names, const ChainModel& chain,
                                       double sign_velocity);

/// Names with units of all columns of the physics: `link2 mcx (kg·m)`, `joint1 viscous (N·m·s/rad)`.
std::vector<std::string> column_names(const Robot& robot, const ChainModel& chain,
                                      const std::vector<EffectModel>& effects);

} // namespace dfdyn::tools
