// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// An F/T sensor that the file declares.
struct DeclaredSensor {
    std::string joint;
    bool parent_to_child = false;
    std::string frame; ///< SDF's word for the frame of the wrench, or empty
};

struct UrdfFile {
    urdf::ModelInterfaceSharedPtr model; ///< a tree: every link has one parent, but for the root
    std::vector<DeclaredSensor> sensors; ///< in order; the first of each joint
};

/// Throws InputError that names the file, and line, link or joint where there is one.
UrdfFile read_urdf_file(const std::filesystem::path& path);

} // namespace dfdyn::tools
