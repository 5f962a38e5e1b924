// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/json_reader.hpp"
#include "tools/model/model.hpp"

#include <nlohmann/json.hpp>

#include <span>

namespace dfdyn::tools {

// Parts of a model.json. Numbers are written in single precision, as in the firmware. Reading throws
// InputError as JsonReader does.

/// Returns the double with the shortest decimal text that represents `value` in single precision.
double single(double value);
nlohmann::ordered_json singles(std::span<const double> values);

nlohmann::ordered_json input_to_json(const InputModel& input);
InputModel read_input(const JsonReader& reader, int joints);

nlohmann::ordered_json start_to_json(const StartModel& start);
StartModel read_start(const JsonReader& reader, int columns, int outputs);

nlohmann::ordered_json physics_to_json(const PhysicsModel& physics);

/// Reads the physics of `model`, whose structure, joints, outputs and features have been read before.
PhysicsModel read_physics(const JsonReader& reader, const TrainedModel& model);

} // namespace dfdyn::tools
