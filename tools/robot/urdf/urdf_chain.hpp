// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/inertia.hpp"
#include "tools/robot/urdf/urdf_file.hpp"

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace dfdyn::tools {

Eigen::Isometry3d to_isometry(const urdf::Pose& pose);

/// Returns the link with this name. Throws InputError if there is none.
urdf::LinkConstSharedPtr find_link(const urdf::ModelInterface& model, const std::string& name,
                                   const std::string& file);

/// Returns the joints between two links, from the upper one down. Throws InputError if `lower` is not below
/// `upper`.
std::vector<urdf::JointConstSharedPtr> joints_between(const urdf::Link& upper, const urdf::Link& lower,
                                                      const std::string& file);

/// Returns the pose of the last joint's child in the first joint's parent, with all joints at zero.
Eigen::Isometry3d placement_along(const std::vector<urdf::JointConstSharedPtr>& joints);

/// Returns the inertia of `link` and all links attached to it, with joints at zero, in the link's frame. The
/// branch at the joint `without` is excluded (null: none).
InertialParameters inertia_of_branch(const urdf::Link& link, const urdf::Joint* without);

/// Adds a note for every impossible `<inertial>` from `link` downwards.
void note_impossible_inertias(const urdf::Link& link, std::vector<std::string>& notes);

/// Returns the fixed joint in `chain` that carries the F/T sensor, by the rules of `read_robot`. Returns null
/// if there is none or, with a note, if it is ambiguous. Throws InputError for an unsuitable `wanted` joint.
urdf::JointConstSharedPtr find_sensor_joint(const std::vector<urdf::JointConstSharedPtr>& chain,
                                            const std::vector<DeclaredSensor>& declared,
                                            const std::string& wanted, const std::string& file,
                                            std::vector<std::string>& notes);

} // namespace dfdyn::tools
