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
    std::string frame; ///< SDF's name for the frame of the wrench, or empty
};

struct UrdfFile {
    urdf::ModelInterfaceSharedPtr model; ///< a tree: every link except the root has one parent
    std::vector<DeclaredSensor> sensors; ///< in order; the first of each joint
};

/// Reads a URDF file. Throws InputError with the file, and the line, link or joint if known.
UrdfFile read_urdf_file(const std::filesystem::path& path);

} // namespace dfdyn::tools
