// SPDX-License-Identifier: Apache-2.0
// Arms, motions and recordings that differ from case to case, as those of users do.
#include "tests/diagnosis/panel/recording/panel_setup.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>
#include <numeric>

namespace dfdyn::tests {

using namespace tools;

namespace {

constexpr double gravity = 9.81;
constexpr double quarter_turn = std::numbers::pi / 2;

/// A part of an arm along a vector in its link's frame.
struct Bar {
    Eigen::Vector3d along; ///< m
    double mass;           ///< kg
};

/// A rod with a centre of mass near its middle.
InertialParameters inertia_of(const Bar& bar, Draw& draw) {
    const double length = bar.along.norm();
    const Eigen::Vector3d direction = bar.along / length;
    const double radius = length * draw.uniform(0.1, 0.3);
    const double axial = bar.mass * radius * radius / 2;
    const double across = axial / 2 + bar.mass * length * length / 12;
    const Eigen::Matrix3d projection = direction * direction.transpose();
    const Eigen::Matrix3d inertia = across * (Eigen::Matrix3d::Identity() - projection) + axial * projection;
    Eigen::Vector3d centre = draw.uniform(0.25, 0.65) * bar.along;
    for (double& coordinate : centre) {
        coordinate += draw.uniform(-0.06, 0.06) * length;
    }
    return body_parameters(bar.mass, centre, inertia * draw.uniform(0.8, 1.3));
}

/// Splits a total into `count` parts that become smaller towards the tip.
std::vector<double> tapered(double total, int count, double slope, Draw& draw) {
    std::vector<double> parts;
    for (int part = 0; part < count; ++part) {
        parts.push_back(std::exp(-slope * part) * draw.uniform(0.6, 1.4));
    }
    const double sum = std::accumulate(parts.begin(), parts.end(), 0.0);
    for (double& part : parts) {
        part *= total / sum;
    }
    return parts;
}

/// Rotation from one joint's axis to the next: parallel or at a right angle.
Eigen::Matrix3d next_axis(bool parallel, Draw& draw) {
    const double bend = parallel ? 0 : draw.sign() * quarter_turn;
    const double turn = draw.chance(0.3) ? draw.uniform(-std::numbers::pi, std::numbers::pi) : 0;
    return (Eigen::AngleAxisd(bend, Eigen::Vector3d::UnitX()) *
            Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()))
        .toRotationMatrix();
}

/// Gravity in the base's frame of an arm on a table, a ceiling or a wall.
Eigen::Vector3d random_gravity(Draw& draw) {
    const double mount = draw.uniform(0, 1);
    const double side = draw.uniform(-std::numbers::pi, std::numbers::pi);
    return mount < 0.8   ? Eigen::Vector3d(0, 0, -gravity)
           : mount < 0.9 ? Eigen::Vector3d(0, 0, gravity)
                         : Eigen::Vector3d(gravity * std::cos(side), gravity * std::sin(side), 0);
}

/// Adds the limits that a robot's file may have. `load` is the largest torque of gravity (N·m).
void add_limits(RobotJoint& joint, double load, bool with_effort, Draw& draw) {
    if (draw.chance(0.8)) {
        joint.lower = -draw.uniform(1.4, 3.1);
        joint.upper = draw.uniform(1.4, 3.1);
    }
    if (with_effort) {
        joint.effort = load * draw.uniform(2, 5);
        joint.velocity = draw.uniform(3, 8);
    }
}

/// Largest torque of gravity at each joint if the arm is stretched out, N·m.
std::vector<double> gravity_loads(const std::vector<Bar>& bars) {
    std::vector<double> loads(bars.size());
    for (std::size_t joint = 0; joint < bars.size(); ++joint) {
        double reach = 0;
        for (std::size_t link = joint; link < bars.size(); ++link) {
            reach += bars[link].along.norm();
            loads[joint] += gravity * bars[link].mass * reach;
        }
    }
    return loads;
}

std::vector<Bar> random_bars(int joints, bool upright, Draw& draw) {
    const double reach = draw.log_uniform(0.25, 2);
    const double mass = 25 * std::pow(reach, 2.2) * draw.log_uniform(0.6, 1.6);
    const std::vector<double> masses = tapered(mass, joints, draw.uniform(0.15, 0.5), draw);
    const std::vector<double> lengths = tapered(reach, joints, draw.uniform(0, 0.4), draw);
    std::vector<Bar> bars;
    for (std::size_t link = 0; link < masses.size(); ++link) {
        const bool along_axis = link == 0 ? upright : draw.chance(0.3);
        const Eigen::Vector3d direction = along_axis ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
        bars.push_back({lengths[link] * direction, masses[link]});
    }
    return bars;
}

/// Puts a force/torque sensor before the tip or below the first joint, and gives its link the two parts.
void add_sensor(Robot& robot, const std::vector<Bar>& bars, Draw& draw) {
    ForceTorqueSensor& sensor = robot.sensor.emplace();
    sensor.joint = "sensor";
    sensor.link = draw.chance(0.2) ? 0 : robot.joints.size();
    sensor.placement.linear() = next_axis(draw.chance(0.5), draw);
    if (sensor.link == 0) {
        return;
    }
    const Bar& bar = bars.back();
    const double where = draw.uniform(0.2, 0.6);  // of the link's length
    const double beyond = draw.uniform(0.3, 0.8); // of the link's mass
    sensor.placement.translation() = where * bar.along;
    Eigen::Isometry3d at_sensor = Eigen::Isometry3d::Identity();
    at_sensor.translation() = sensor.placement.translation();
    sensor.inertia_beyond = moved(inertia_of({(1 - where) * bar.along, beyond * bar.mass}, draw), at_sensor);
    robot.joints.back().inertia =
        inertia_of({where * bar.along, (1 - beyond) * bar.mass}, draw) + sensor.inertia_beyond;
}

Robot random_arm(OutputKind outputs, Draw& draw) {
    const int joints = draw.whole(2, 7);
    const bool upright = draw.chance(0.75); // the first axis is the base's normal
    const std::vector<Bar> bars = random_bars(joints, upright, draw);
    const std::vector<double> loads = gravity_loads(bars);
    const bool with_effort = draw.chance(0.6);
    Robot robot;
    robot.name = "unknown_arm";
    robot.base = "base";
    robot.tip = "tip";
    robot.gravity = random_gravity(draw);
    for (std::size_t link = 0; link < bars.size(); ++link) {
        RobotJoint joint;
        joint.name = "joint" + std::to_string(link + 1);
        joint.link = "link" + std::to_string(link + 1);
        const bool parallel = link == 0 ? upright : !draw.chance(link == 1 && upright ? 0.85 : 0.5);
        joint.placement.linear() = next_axis(parallel, draw);
        joint.placement.translation() = link == 0 ? Eigen::Vector3d::Zero().eval() : bars[link - 1].along;
        joint.inertia = inertia_of(bars[link], draw);
        add_limits(joint, loads[link], with_effort, draw);
        robot.joints.push_back(joint);
    }
    robot.tip_placement.translation() = bars.back().along;
    if (outputs == OutputKind::wrench) {
        add_sensor(robot, bars, draw);
    }
    return robot;
}

OutputKind random_outputs(Draw& draw) {
    const double kind = draw.uniform(0, 1);
    return kind < 0.45  ? OutputKind::joint_torque
           : kind < 0.8 ? OutputKind::motor_current
                        : OutputKind::wrench;
}

PanelConditions unknown_conditions(Draw& draw) {
    PanelConditions conditions;
    conditions.rates_hz = {50, 100, 125, 200, 250, 500};
    conditions.least_bits = 12;
    conditions.sensor_bits = 28; // its last link may weigh a hundredth of the sensor's payload
    conditions.largest_noise = draw.log_uniform(0.02, 0.15);
    conditions.least_noise = conditions.largest_noise / 5;
    conditions.shortest_s = 20;
    conditions.longest_s = 120;
    conditions.most_redraws = 10; // a slow arm with large noise shows no strong effect
    conditions.ordinary_share = 0.6;
    conditions.everyday_motion = true;
    return conditions;
}

/// Torque of gravity on the stretched arm at half of its reach, N·m.
double weight_torque(const Robot& robot) {
    double mass = 0;
    for (const RobotJoint& joint : robot.joints) {
        mass += joint.inertia[0];
    }
    return gravity * mass * reach_of(robot) / 2;
}

} // namespace

double reach_of(const Robot& robot) {
    double reach = robot.tip_placement.translation().norm();
    for (const RobotJoint& joint : robot.joints) {
        reach += joint.placement.translation().norm();
    }
    return reach;
}

UnknownArm draw_unknown_arm(std::uint64_t seed) {
    Draw draw(seed, 4);
    UnknownArm arm;
    arm.kind.name = unknown_arm;
    arm.kind.tip = "tip";
    arm.kind.outputs = random_outputs(draw);
    arm.kind.speed = draw.log_uniform(0.5, 2.5);
    arm.kind.largest_range = draw.uniform(0.6, 2);
    arm.kind.conditions = unknown_conditions(draw);
    arm.robot = random_arm(arm.kind.outputs, draw);
    arm.kind.conditions.least_constant = weight_torque(arm.robot) / draw.log_uniform(2, 20); // A
    arm.kind.conditions.largest_constant = 2 * arm.kind.conditions.least_constant;
    return arm;
}

} // namespace dfdyn::tests
