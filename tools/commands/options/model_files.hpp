// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/system/file_set.hpp"
#include "tools/commands/options/options.hpp"
#include "tools/model/model.hpp"
#include "tools/robot/robot.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace dfdyn::tools {

/// Returns the content of model.json. Throws InputError, naming `path`, if `replay` would reject it.
std::string checked_json(const TrainedModel& model, const std::filesystem::path& path);

/// Adds the model as `json` and, unless `header` is empty, as a header in a namespace named as that file.
/// Throws as checked_json().
void add_model(FileSet& files, const TrainedModel& model, const std::filesystem::path& json,
               const std::filesystem::path& header);

/// Records in a model how the recordings were read that made it: `replay` reads others in the same way.
void describe_reading(const RecordingOptions& recordings, const std::optional<Robot>& robot,
                      TrainedModel& model);

} // namespace dfdyn::tools
