// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/file_place.hpp"

namespace dfdyn::tools {

namespace fs = std::filesystem;

fs::path place_in_file_system(const fs::path& path) {
    if (path.empty()) {
        return path;
    }
    std::error_code without_place;
    fs::path place = fs::weakly_canonical(fs::absolute(path), without_place);
    place = without_place ? fs::absolute(path) : place;
    return place.has_filename() ? place : place.parent_path();
}

bool in_same_folder(const fs::path& one, const fs::path& other) {
    return place_in_file_system(fs::absolute(one).parent_path()) ==
           place_in_file_system(fs::absolute(other).parent_path());
}

} // namespace dfdyn::tools
