// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/urdf/urdf_chain.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

namespace {

InertialParameters own_inertia(const urdf::Link& link) {
    if (link.inertial == nullptr) {
        return InertialParameters::Zero();
    }
    const urdf::Inertial& given = *link.inertial;
    Eigen::Matrix3d inertia;
    inertia << given.ixx, given.ixy, given.ixz, given.ixy, given.iyy, given.iyz, given.ixz, given.iyz,
        given.izz;
    return moved(body_parameters(given.mass, Eigen::Vector3d::Zero(), inertia), to_isometry(given.origin));
}

} // namespace

Eigen::Isometry3d to_isometry(const urdf::Pose& pose) {
    double x = 0;
    double y = 0;
    double z = 0;
    double w = 1;
    pose.rotation.getQuaternion(x, y, z, w);
    return Eigen::Translation3d(pose.position.x, pose.position.y, pose.position.z) *
           Eigen::Quaterniond(w, x, y, z).normalized();
}

urdf::LinkConstSharedPtr find_link(const urdf::ModelInterface& model, const std::string& name,
                                   const std::string& file) {
    urdf::LinkConstSharedPtr link = model.getLink(name);
    if (link == nullptr) {
        std::vector<std::string> names;
        for (const auto& [key, value] : model.links_) {
            names.push_back(key);
        }
        throw InputError(file + ": expected a link " + in_quotes(name) + ", found " + listed(names) +
                         suggestion(name, names));
    }
    return link;
}

std::vector<urdf::JointConstSharedPtr> joints_between(const urdf::Link& upper, const urdf::Link& lower,
                                                      const std::string& file) {
    std::vector<urdf::JointConstSharedPtr> joints;
    urdf::LinkSharedPtr above;
    for (const urdf::Link* link = &lower; link->name != upper.name; link = above.get()) {
        above = link->getParent();
        if (above == nullptr) {
            throw InputError(file + ": expected link " + in_quotes(lower.name) + " below link " +
                             in_quotes(upper.name) + ", found it on another branch");
        }
        joints.push_back(link->parent_joint);
    }
    std::ranges::reverse(joints);
    return joints;
}

Eigen::Isometry3d placement_along(const std::vector<urdf::JointConstSharedPtr>& joints) {
    Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
    for (const auto& joint : joints) {
        placement = placement * to_isometry(joint->parent_to_joint_origin_transform);
    }
    return placement;
}

InertialParameters inertia_of_branch(const urdf::Link& link, const urdf::Joint* without) {
    InertialParameters total = InertialParameters::Zero();
    std::vector<std::pair<const urdf::Link*, Eigen::Isometry3d>> open{{&link, Eigen::Isometry3d::Identity()}};
    while (!open.empty()) {
        const auto [at, placement] = open.back();
        open.pop_back();
        total += moved(own_inertia(*at), placement);
        for (const urdf::LinkSharedPtr& child : at->child_links) {
            if (child->parent_joint.get() != without) {
                open.emplace_back(child.get(),
                                  placement *
                                      to_isometry(child->parent_joint->parent_to_joint_origin_transform));
            }
        }
    }
    return total;
}

void note_impossible_inertias(const urdf::Link& link, std::vector<std::string>& notes) {
    std::vector<const urdf::Link*> open{&link};
    while (!open.empty()) {
        const urdf::Link* const at = open.back();
        open.pop_back();
        if (const auto fault = inertia_fault(own_inertia(*at))) {
            notes.push_back("link " + in_quotes(at->name) + ": " + *fault);
        }
        for (const urdf::LinkSharedPtr& child : at->child_links) {
            open.push_back(child.get());
        }
    }
}

} // namespace dfdyn::tools
