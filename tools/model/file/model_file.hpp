// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace dfdyn::tools {

/// Returns the smallest forgetting factor of a model with d random features: a memory of one sample per
/// column. With a shorter memory the weights would be undetermined.
double least_forgetting_factor(int feature_count);

/// Returns the text of a model.json (schema dfdyn.model/1). Numbers have single precision, as in the
/// firmware; reading the text restores them bit for bit.
std::string model_to_json(const TrainedModel& model);

/// Reads a model from `text`; `source` names it in messages. Throws InputError in one line (where, expected,
/// found) if a value is missing, has a wrong size, is not finite, or is out of range.
TrainedModel model_from_json(const std::string& text, const std::string& source);

/// Reads a model.json. Throws InputError as above, or if the file cannot be read.
TrainedModel read_model(const std::filesystem::path& path);

/// Returns a number that distinguishes models: the CRC-32 of the content of model.json without the limits of
/// contacts, on which nothing learned depends. Snapshots contain it.
std::uint32_t model_identity(const TrainedModel& model);

} // namespace dfdyn::tools
