// SPDX-License-Identifier: Apache-2.0
#include "tools/base/bag/bag.hpp"

#include "tools/base/text/text.hpp"

#include <algorithm>
#include <fstream>
#include <string_view>
#include <system_error>

namespace dfdyn::tools {

namespace {

enum class BagFormat { none, mcap, sqlite };

BagFormat format_of(const std::filesystem::path& file) {
    using namespace std::literals;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) {
        return BagFormat::none;
    }
    std::ifstream stream(file, std::ios::binary);
    std::string begin(16, '\0');
    stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
    if (begin.starts_with("\x89MCAP0\r\n"sv)) {
        return BagFormat::mcap;
    }
    return begin == "SQLite format 3\0"sv ? BagFormat::sqlite : BagFormat::none;
}

} // namespace

std::vector<std::filesystem::path> bag_files(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::is_directory(path, ignored)) {
        return {path};
    }
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(path, ignored)) {
        if (format_of(entry.path()) != BagFormat::none) {
            files.push_back(entry.path());
        }
    }
    std::ranges::sort(files, {}, [](const std::filesystem::path& file) { // run_9.mcap before run_10.mcap
        return std::pair(file.native().size(), file.native());
    });
    return files;
}

bool is_bag(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_directory(path, ignored) ? !bag_files(path).empty()
                                                        : format_of(path) != BagFormat::none;
}

void visit_bag(const std::filesystem::path& path, const BagVisitor& visit) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) {
        for (const std::filesystem::path& file : bag_files(path)) {
            visit_bag(file, visit);
        }
    } else if (format_of(path) == BagFormat::mcap) {
        visit_mcap(path, visit);
    } else {
        visit_sqlite_bag(path, visit);
    }
}

} // namespace dfdyn::tools
