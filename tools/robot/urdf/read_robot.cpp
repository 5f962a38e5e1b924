// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/urdf/read_robot.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/robot/urdf/urdf_chain.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr std::size_t most_joints = 64;

/// Builds the robot from base to tip.
class ChainBuilder {
  public:
    ChainBuilder(std::string file, urdf::JointConstSharedPtr sensor_joint)
        : file_(std::move(file)), sensor_joint_(std::move(sensor_joint)) {}

    void pass(const urdf::Joint& joint) {
        check_supported(joint);
        const Eigen::Isometry3d placement = placement_ * to_isometry(joint.parent_to_joint_origin_transform);
        if (joint.type == urdf::Joint::FIXED) {
            placement_ = placement;
            if (&joint == sensor_joint_.get()) {
                robot_.sensor = ForceTorqueSensor{joint.name, robot_.joints.size(), placement, false,
                                                  InertialParameters::Zero()};
            }
        } else {
            add_moving(joint, placement);
        }
    }

    /// Adds a link of the chain, and the branches attached to it, to the current merged link.
    void count(const urdf::Link& link, const urdf::Joint* next) {
        const InertialParameters inertia = moved(inertia_of_branch(link, next), placement_);
        if (!robot_.joints.empty()) {
            robot_.joints.back().inertia += inertia;
        }
        if (robot_.sensor && robot_.sensor->link == robot_.joints.size()) {
            robot_.sensor->inertia_beyond += inertia;
        }
    }

    Robot finish() {
        robot_.tip_placement = placement_;
        return std::move(robot_);
    }

  private:
    InputError error(const urdf::Joint& joint, const std::string& found) const {
        return InputError(file_ + ": joint " + in_quotes(joint.name) +
                          ": expected a revolute, continuous, prismatic or fixed joint of its own, found " +
                          found);
    }

    void check_supported(const urdf::Joint& joint) const {
        if (joint.type == urdf::Joint::PLANAR || joint.type == urdf::Joint::FLOATING) {
            throw error(joint, joint.type == urdf::Joint::PLANAR ? "a planar one" : "a floating one");
        }
        if (joint.mimic != nullptr) {
            throw error(joint, "one that mimics joint " + in_quotes(joint.mimic->joint_name));
        }
    }

    void add_moving(const urdf::Joint& joint, const Eigen::Isometry3d& placement) {
        if (robot_.joints.size() == most_joints) {
            throw InputError(file_ + ": joint " + in_quotes(joint.name) + ": expected at most " +
                             std::to_string(most_joints) + " moving joints between base and tip, found more");
        }
        RobotJoint moving;
        moving.name = joint.name;
        moving.link = joint.child_link_name;
        moving.prismatic = joint.type == urdf::Joint::PRISMATIC;
        moving.placement = placement;
        moving.axis = axis_of(joint);
        add_limits(joint, moving);
        robot_.joints.push_back(std::move(moving));
        placement_ = Eigen::Isometry3d::Identity();
    }

    Eigen::Vector3d axis_of(const urdf::Joint& joint) const {
        const Eigen::Vector3d axis(joint.axis.x, joint.axis.y, joint.axis.z);
        if (!(axis.norm() > 1e-9)) {
            throw InputError(file_ + ": joint " + in_quotes(joint.name) +
                             ": expected an axis of some length, found zero");
        }
        return axis.normalized();
    }

    void add_limits(const urdf::Joint& joint, RobotJoint& moving) {
        if (joint.limits == nullptr) {
            return;
        }
        if (joint.limits->effort > 0) {
            moving.effort = joint.limits->effort;
        }
        if (joint.limits->velocity > 0) {
            moving.velocity = joint.limits->velocity;
        }
        if (joint.type == urdf::Joint::CONTINUOUS) {
            return;
        }
        if (joint.limits->lower < joint.limits->upper) {
            moving.lower = joint.limits->lower;
            moving.upper = joint.limits->upper;
        } else {
            robot_.notes.push_back(
                "joint " + in_quotes(joint.name) +
                ": its lower limit is not below its upper one; it counts as without limits");
        }
    }

    std::string file_;
    urdf::JointConstSharedPtr sensor_joint_;
    Eigen::Isometry3d placement_ = Eigen::Isometry3d::Identity(); ///< of the URDF's link in the merged one
    Robot robot_;
};

void add_direction(Robot& robot, const std::vector<DeclaredSensor>& declared,
                   const std::optional<bool>& wanted) {
    if (!robot.sensor) {
        return;
    }
    const auto own = std::ranges::find(declared, robot.sensor->joint, &DeclaredSensor::joint);
    if (own != declared.end()) {
        robot.sensor->parent_to_child = own->parent_to_child;
        if (!own->frame.empty() && own->frame != "child") {
            robot.notes.push_back("F/T sensor at joint " + in_quotes(robot.sensor->joint) +
                                  ": the file gives its wrench in frame " + in_quotes(own->frame) +
                                  "; it is assumed to be in the frame of the joint's child");
        }
    }
    robot.sensor->parent_to_child = wanted.value_or(robot.sensor->parent_to_child);
}

void note_oddities(const urdf::ModelInterface& model, const urdf::Joint& first_moving, Robot& robot) {
    note_impossible_inertias(*model.getLink(first_moving.child_link_name), robot.notes);
    for (const RobotJoint& joint : robot.joints) {
        if (joint.inertia.isZero(0)) {
            robot.notes.push_back("link " + in_quotes(joint.link) + ": moves, but has no inertia");
        }
        for (const auto& [name, other] : model.joints_) {
            if (other->mimic != nullptr && other->mimic->joint_name == joint.name) {
                robot.notes.push_back("joint " + in_quotes(name) + ": mimics joint " + in_quotes(joint.name) +
                                      ", but is held at zero");
            }
        }
    }
}

} // namespace

Robot read_robot(const std::filesystem::path& path, const ReadRobotOptions& options) {
    const std::string file = shown(path);
    const UrdfFile urdf = read_urdf_file(path);
    const urdf::Link& root = *urdf.model->getRoot();
    const auto base = find_link(*urdf.model, options.base.empty() ? root.name : options.base, file);
    const auto tip = find_link(*urdf.model, options.tip, file);
    const auto chain = joints_between(*base, *tip, file);
    const auto moves = [](const auto& joint) { return joint->type != urdf::Joint::FIXED; };
    const auto first_moving = std::ranges::find_if(chain, moves);
    if (first_moving == chain.end()) {
        throw InputError(file + ": expected a moving joint between link " + in_quotes(base->name) +
                         " and link " + in_quotes(tip->name) + ", found none");
    }
    std::vector<std::string> notes;
    ChainBuilder builder(file, find_sensor_joint(chain, urdf.sensors, options.ft_joint, file, notes));
    for (const auto& joint : chain) {
        builder.count(*urdf.model->getLink(joint->parent_link_name), joint.get());
        builder.pass(*joint);
    }
    builder.count(*tip, nullptr);
    Robot robot = builder.finish();
    robot.name = urdf.model->getName();
    robot.base = base->name;
    robot.tip = tip->name;
    robot.base_in_root = placement_along(joints_between(root, *base, file)).rotation();
    robot.gravity = robot.base_in_root.transpose() * options.gravity;
    robot.notes.insert(robot.notes.begin(), notes.begin(), notes.end());
    add_direction(robot, urdf.sensors, options.parent_to_child);
    note_oddities(*urdf.model, **first_moving, robot);
    return robot;
}

} // namespace dfdyn::tools
