// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/error.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace dfdyn::tools {

/// Returns the error `PATH: CANNOT: REASON` for an input that cannot be opened. If there is no such file, it
/// suggests the nearest name in the folder.
InputError input_error(const std::filesystem::path& path, std::string_view cannot, int error_number);

/// Returns all bytes of a file. Throws InputError "PATH: CANNOT: the system's reason" if it cannot be read or
/// is empty; `cannot`: e.g. "cannot be read as a model".
std::string read_file(const std::filesystem::path& path, std::string_view cannot = "cannot read");

} // namespace dfdyn::tools
