// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/plan/file_checksum.hpp"

#include "dfdyn/core/snapshot.hpp"
#include "tools/base/system/read_file.hpp"
#include "tools/base/text/text.hpp"

#include <array>
#include <cstdio>
#include <span>

namespace dfdyn::tools {

std::string file_checksum(const std::filesystem::path& path) {
    const std::string content = read_file(path);
    std::array<char, 9> text{};
    std::snprintf(text.data(), text.size(), "%08x", crc32(std::as_bytes(std::span(content))));
    return std::string(text.data()) + ", " + std::to_string(content.size()) + " bytes";
}

} // namespace dfdyn::tools
