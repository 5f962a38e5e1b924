// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/read_file.hpp"

#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <system_error>
#include <vector>

namespace dfdyn::tools {

InputError input_error(const std::filesystem::path& path, std::string_view cannot, int error_number) {
    if (std::error_code ignored; error_number == ENOENT && std::filesystem::is_symlink(path, ignored)) {
        return InputError(shown(path) + ": " + std::string(cannot) + ": expected a file, found a link to " +
                          shown(std::filesystem::read_symlink(path, ignored)) + ", which does not exist");
    }
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
        if (entry->path().filename() != path.filename()) { // a link to a missing file has the name itself
            names.push_back(entry->path().filename().string());
        }
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
    constexpr std::size_t most_bytes = std::size_t{256} << 20U; // /dev/zero has no end
    std::string content;
    std::array<char, 1U << 16U> part{};
    while (file.read(part.data(), part.size()) || file.gcount() > 0) {
        content.append(part.data(), static_cast<std::size_t>(file.gcount()));
        if (content.size() > most_bytes) {
            throw InputError(shown(path) + ": " + std::string(cannot) +
                             ": expected at most 256 MiB, found more");
        }
    }
    if (file.bad() || !file.is_open() || (content.empty() && errno != 0)) {
        throw input_error(path, cannot, errno);
    }
    if (content.empty()) {
        throw InputError(shown(path) + ": " + std::string(cannot) +
                         ": expected content, found an empty file");
    }
    return content;
}

} // namespace dfdyn::tools
