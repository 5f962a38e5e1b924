// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/inertia.hpp"
#include "tools/robot/urdf/urdf_file.hpp"

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace dfdyn::tools {

Eigen::Isometry3d to_isometry(const urdf::Pose& pose);

/// The link of that name; throws InputError when there is none.
urdf::LinkConstSharedPtr find_link(const urdf::ModelInterface& model, const std::string& name,
                                   const std::string& file);

/// The joints between two links, from the upper one down; throws InputError when `lower` is not below
/// `upper`.
std::vector<urdf::JointConstSharedPtr> joints_between(const urdf::Link& upper, const urdf::Link& lower,
                                                      const std::string& file);

/// Where the last joint's child sits in the first joint's parent, all joints at zero.
Eigen::Isometry3d placement_along(const std::vector<urdf::JointConstSharedPtr>& joints);

/// Inertia of `link` and all that hangs on it, joints at zero, in the link's frame; not counted is what hangs
/// on the joint `without` (null: all counts).
InertialParameters inertia_of_branch(const urdf::Link& link, const urdf::Joint* without);

/// A note for every `<inertial>` from `link` downwards that no body can have.
void note_impossible_inertias(const urdf::Link& link, std::vector<std::string>& notes);

/// The fixed joint, among `chain`, that carries the F/T sensor, by the rules of `read_robot`; null when there
/// is none or, with a note, no telling which. Throws InputError for a `wanted` one that cannot be it.
urdf::JointConstSharedPtr find_sensor_joint(const std::vector<urdf::JointConstSharedPtr>& chain,
                                            const std::vector<DeclaredSensor>& declared,
                                            const std::string& wanted, const std::string& file,
                                            std::vector<std::string>& notes);

} // namespace dfdyn::tools
