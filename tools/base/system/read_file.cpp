// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/read_file.hpp"

#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>
#include <vector>

namespace dfdyn::tools {

InputError input_error(const std::filesystem::path& path, std::string_view cannot, int error_number) {
    const InputError error = system_error(path, cannot, error_number);
    if (error_number != ENOENT || !path.has_filename()) {
        return error;
    }
    constexpr std::size_t most_names = 10'000; // of a folder, so that a message takes no time
    std::vector<std::string> names;
    std::error_code ignored;
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
    for (std::filesystem::directory_iterator entry(folder, ignored), end;
         entry != end && names.size() < most_names; entry.increment(ignored)) {
        names.push_back(entry->path().filename().string());
    }
    std::ranges::sort(names); // the order of a folder is arbitrary
    return InputError(error.what() + suggestion(path.filename().string(), names));
}

std::string read_file(const std::filesystem::path& path, std::string_view cannot) {
    if (std::error_code ignored; std::filesystem::is_directory(path, ignored)) {
        throw system_error(path, cannot, EISDIR);
    }
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (!file || (content.empty() && errno != 0)) {
        throw input_error(path, cannot, errno);
    }
    if (content.empty()) {
        throw InputError(shown(path) + ": " + std::string(cannot) +
                         ": expected content, found an empty file");
    }
    return content;
}

} // namespace dfdyn::tools
