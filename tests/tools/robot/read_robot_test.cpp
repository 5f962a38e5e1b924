// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/urdf/read_robot.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/temporary_directory.hpp"

#include <string>

namespace tools = dfdyn::tools;

namespace {

using Catch::Matchers::ContainsSubstring;

std::string body(const std::string& name, const std::string& mass = "1", const std::string& izz = "0.02") {
    return "<link name='" + name + "'><inertial><origin xyz='0.1 0 0'/><mass value='" + mass +
           "'/><inertia ixx='0.02' iyy='0.02' izz='" + izz + "' ixy='0' ixz='0' iyz='0'/></inertial></link>";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& more = "") {
    return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" +
           child +
           "'/><origin xyz='0 0 1'/><axis xyz='0 2 0'/><limit lower='-1' upper='2' effort='3' "
           "velocity='4'/>" +
           more + "</joint>";
}

/// root -a- one -flange(fixed)- two -b(prismatic)- three -end(fixed)- tip, and a gripper on `two` and `tip`.
std::string arm(const std::string& more = "") {
    return "<robot name='arm'>" + body("root") + body("one") + body("two") + body("three") + body("finger") +
           body("thumb") + "<link name='tip'/>" + joint("a", "revolute", "root", "one") +
           joint("flange", "fixed", "one", "two") + joint("b", "prismatic", "two", "three") +
           joint("end", "fixed", "three", "tip") + joint("grip", "revolute", "two", "finger") +
           joint("pinch", "continuous", "tip", "thumb") + more + "</robot>";
}

tools::Robot read(const std::string& text, tools::ReadRobotOptions options = {}) {
    const dfdyn::tests::TemporaryDirectory directory;
    options.tip = options.tip.empty() ? "tip" : options.tip;
    return tools::read_robot(directory.write("arm.urdf", text), options);
}

std::string ft_sensor(const std::string& at, const std::string& direction = "") {
    return "<gazebo reference='" + at + "'><sensor name='s' type='force_torque'><force_torque>" +
           "<measure_direction>" + direction + "</measure_direction></force_torque></sensor></gazebo>";
}

} // namespace

TEST_CASE("fixed joints are merged and branches belong to the link that carries them") {
    const tools::Robot robot = read(arm());
    CHECK(robot.name == "arm");
    CHECK(robot.base == "root");
    REQUIRE(robot.joints.size() == 2);
    CHECK(robot.joints[0].inertia[0] == Approx(3)); // one, two, finger
    CHECK(robot.joints[0].inertia[3] == Approx(0 + 1 + 2));
    CHECK(robot.joints[1].inertia[0] == Approx(2)); // three, thumb
    CHECK(robot.joints[1].prismatic);
    CHECK(robot.joints[1].placement.translation().z() == Approx(2)); // including the flange
    CHECK(robot.joints[1].axis == Eigen::Vector3d::UnitY());
    CHECK(robot.tip_placement.translation().z() == Approx(1));
    CHECK(robot.joints[0].lower == Approx(-1));
    CHECK(robot.joints[0].velocity == Approx(4));
    CHECK_FALSE(robot.sensor);
    CHECK(robot.notes.empty());
}

TEST_CASE("gravity is rotated from the root's frame into the base's frame") {
    const std::string turned = "<robot name='r'><link name='world'/>" + body("root") + body("one") +
                               "<joint name='w' type='revolute'><parent link='world'/><child link='root'/>"
                               "<origin rpy='1.5707963267948966 0 0'/><axis xyz='1 0 0'/>"
                               "<limit lower='0' upper='1' effort='1' velocity='1'/></joint>" +
                               joint("a", "revolute", "root", "one") + "</robot>";
    tools::ReadRobotOptions options;
    options.tip = "one";
    options.base = "root";
    CHECK((read(turned, options).gravity - Eigen::Vector3d(0, -9.81, 0)).norm() < 1e-12);
    options.gravity = {1, 2, 3};
    CHECK((read(turned, options).gravity - Eigen::Vector3d(1, 3, -2)).norm() < 1e-12);
}

TEST_CASE("the F/T sensor is read from its declaration with its direction") {
    const tools::Robot robot = read(arm(ft_sensor("flange", "parent_to_child") + ft_sensor("a")));
    REQUIRE(robot.sensor);
    CHECK(robot.sensor->joint == "flange");
    CHECK(robot.sensor->link == 1);
    CHECK(robot.sensor->parent_to_child);
    CHECK(robot.sensor->placement.translation().z() == Approx(1));
    CHECK(robot.sensor->inertia_beyond[0] == Approx(2)); // two, finger
    tools::ReadRobotOptions options;
    options.parent_to_child = false;
    CHECK_FALSE(read(arm(ft_sensor("flange", "parent_to_child")), options).sensor->parent_to_child);
    const std::string top_level = "<sensor name='s' type='force_torque'><parent joint='end'/></sensor>";
    const tools::Robot other = read(arm(top_level));
    REQUIRE(other.sensor);
    CHECK(other.sensor->link == 2);
    CHECK(other.sensor->inertia_beyond[0] == Approx(1)); // tip, thumb
    CHECK_FALSE(other.sensor->parent_to_child);
}

TEST_CASE("the F/T sensor is found by the name of its joint or by an option") {
    const auto renamed = [](const std::string& name) {
        std::string text = arm();
        const std::string old = "'flange'";
        return text.replace(text.find(old), old.size(), "'" + name + "'");
    };
    for (const std::string name : {"wrist_ft_sensor", "wrist-ft", "ft_1", "my_force_torque_joint"}) {
        CAPTURE(name);
        CHECK(read(renamed(name)).sensor);
    }
    for (const std::string name : {"left_wrist", "shaft", "soft_pad"}) {
        CAPTURE(name);
        CHECK_FALSE(read(renamed(name)).sensor);
    }
    tools::ReadRobotOptions options;
    options.ft_joint = "end";
    CHECK(read(arm(ft_sensor("flange")), options).sensor->joint == "end");
    const tools::Robot two = read(arm(ft_sensor("flange") + ft_sensor("end")));
    CHECK_FALSE(two.sensor);
    REQUIRE(two.notes.size() == 1);
    CHECK_THAT(two.notes[0], ContainsSubstring("flange, end"));
}

TEST_CASE("unusual but usable properties are noted with their link or joint") {
    std::string text = arm("<joint name='m' type='revolute'><parent link='tip'/><child link='x'/>"
                           "<limit effort='1' velocity='1'/><axis xyz='1 0 0'/><mimic joint='a'/></joint>" +
                           body("x", "-1") + body("y", "1", "0.1") + joint("f", "fixed", "x", "y"));
    const std::string limit = "<limit lower='-1' upper='2'";
    text.replace(text.find(limit), limit.size(), "<limit lower='2' upper='2'");
    const tools::Robot robot = read(text);
    REQUIRE(robot.notes.size() == 4);
    CHECK_THAT(robot.notes[0], ContainsSubstring("joint \"a\"") && ContainsSubstring("without limits"));
    CHECK_THAT(robot.notes[1] + robot.notes[2], ContainsSubstring("link \"x\": mass") &&
                                                    ContainsSubstring("link \"y\": one of its principal"));
    CHECK_THAT(robot.notes[3], ContainsSubstring("joint \"m\": mimics joint \"a\""));
    CHECK_FALSE(robot.joints[0].lower);
    const tools::Robot weightless = read("<robot name='r'><link name='root'/><link name='tip'/>" +
                                         joint("a", "continuous", "root", "tip") + "</robot>");
    REQUIRE(weightless.notes.size() == 1);
    CHECK_THAT(weightless.notes[0], ContainsSubstring("link \"tip\": moves, but has no inertia"));
    CHECK_FALSE(weightless.joints[0].lower);
}
