// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/read_file.hpp"

#include "tools/base/text/text.hpp"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>

namespace dfdyn::tools {

std::string read_file(const std::filesystem::path& path, std::string_view cannot) {
    if (std::error_code ignored; std::filesystem::is_directory(path, ignored)) {
        throw system_error(path, cannot, EISDIR);
    }
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (!file || content.empty()) {
        throw system_error(path, cannot, errno != 0 ? errno : ENODATA);
    }
    return content;
}

} // namespace dfdyn::tools
