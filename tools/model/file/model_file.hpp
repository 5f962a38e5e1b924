// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace dfdyn::tools {

/// The name of an input as on the command line and in model.json.
std::string to_string(InputKind kind);

/// The input of that name; throws InputError listing the names for any other.
InputKind parse_input_kind(const std::string& name);

/// The smallest forgetting factor of a model with d random features: a memory of one sample per column. A
/// shorter one determines none of the weights.
double least_forgetting_factor(int feature_count);

/// Whether a structure (NP, P, SP, SP2, SPK) has random features, and whether it has physics.
bool has_features(const std::string& structure);
bool has_physics(const std::string& structure);
/// Whether the physics' parameters are learned: P, SPK.
bool learns_parameters(const std::string& structure);

/// The text of a model.json (schema dfdyn.model/1). Numbers are those of single precision, which is what the
/// firmware runs with; reading the text back gives them bit for bit.
std::string model_to_json(const TrainedModel& model);

/// The model in `text`; `source` names it in messages. Throws InputError in one line (where, expected, found)
/// unless all of it is there, of the right sizes, finite and in its valid range.
TrainedModel model_from_json(const std::string& text, const std::string& source);

/// Reads a model.json; throws InputError as above, or if the file cannot be read.
TrainedModel read_model(const std::filesystem::path& path);

/// A number that differs between models: the CRC-32 of what is in model.json. Snapshots carry it.
std::uint32_t model_identity(const TrainedModel& model);

} // namespace dfdyn::tools
