// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace dfdyn::tools {

/// Returns the absolute path without links and without a separator at its end; a pipe of the shell is not
/// followed. Paths of one file or folder have the same place.
std::filesystem::path place_in_file_system(const std::filesystem::path& path);

/// Returns whether the two files are named in the same folder.
bool in_same_folder(const std::filesystem::path& one, const std::filesystem::path& other);

} // namespace dfdyn::tools
