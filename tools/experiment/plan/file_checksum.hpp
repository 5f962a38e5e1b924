// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace dfdyn::tools {

/// Returns "1a2b3c4d, 12345 bytes": CRC-32 and size of a file. Throws InputError if it cannot be read.
std::string file_checksum(const std::filesystem::path& path);

} // namespace dfdyn::tools
