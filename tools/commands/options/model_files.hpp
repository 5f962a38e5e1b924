// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/system/file_set.hpp"
#include "tools/model/model.hpp"

#include <filesystem>

namespace dfdyn::tools {

/// Adds the model as `json` and, unless `header` is empty, as a header in a namespace named as that file.
/// Throws InputError if `replay` would reject the model.
void add_model(FileSet& files, const TrainedModel& model, const std::filesystem::path& json,
               const std::filesystem::path& header);

} // namespace dfdyn::tools
