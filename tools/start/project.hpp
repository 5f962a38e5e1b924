// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/model/model.hpp"

#include <filesystem>
#include <map>
#include <span>
#include <string>

namespace dfdyn::tools {

/// Content of files by their path within a folder.
using FolderContent = std::map<std::string, std::string>;

/// Returns the files of a CMake project that runs `model` over the first rows of the longest one of
/// `recordings` (at least one), on the host and on a bare Cortex-M: sources, the model as a header, the
/// firmware library, board support and a toolchain file. The rows end with the hundredth prediction, or with
/// the recording. The project needs no other files.
FolderContent project_files(const TrainedModel& model, std::span<const Recording> recordings);

/// Throws InputError unless `folder` does not exist or is an empty folder, and its parent is writable.
void require_new_folder(const std::filesystem::path& folder);

/// Creates `folder` with all files, or nothing: writes a temporary folder, then renames it. Throws InputError
/// with path and reason.
void write_folder(const std::filesystem::path& folder, const FolderContent& content);

} // namespace dfdyn::tools
