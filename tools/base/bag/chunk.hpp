// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Returns the content of an MCAP chunk that is compressed with `compression` (``, `lz4` or `zstd`) and has
/// `size` bytes when decompressed. Throws InputError, starting with `what`, for damaged content, another
/// compression, one that this program was built without, and a size that the content cannot have.
std::vector<std::byte> decompressed_chunk(std::span<const std::byte> content, std::string_view compression,
                                          std::uint64_t size, const std::string& what);

} // namespace dfdyn::tools
