// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/error.hpp"
#include "tools/robot/urdf/read_robot.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/temporary_directory.hpp"

#include <string>

namespace tools = dfdyn::tools;

namespace {

using Catch::Matchers::ContainsSubstring;

std::string links(int count) {
    std::string text;
    for (int i = 0; i <= count; ++i) {
        text += "<link name='l" + std::to_string(i) + "'/>";
    }
    return text;
}

std::string joint(int number, const std::string& type = "continuous", const std::string& axis = "0 0 1",
                  const std::string& more = "") {
    const std::string n = std::to_string(number);
    return "<joint name='j" + n + "' type='" + type + "'><parent link='l" + std::to_string(number - 1) +
           "'/><child link='l" + n + "'/><axis xyz='" + axis + "'/>" + more + "</joint>";
}

std::string robot(const std::string& content) { return "<robot name='r'>" + content + "</robot>"; }

/// The error message for the file, empty if it is accepted.
std::string refusal(const std::string& text, const tools::ReadRobotOptions& options) {
    const dfdyn::tests::TemporaryDirectory directory;
    try {
        tools::read_robot(directory.write("r.urdf", text), options);
    } catch (const tools::InputError& error) {
        return error.what();
    }
    return {};
}

std::string refusal(const std::string& text, const std::string& tip = "l1") {
    tools::ReadRobotOptions options;
    options.tip = tip;
    return refusal(text, options);
}

} // namespace

TEST_CASE("a file that is not URDF is rejected with one line that names it") {
    const std::string files[] = {
        "",
        "not XML",
        "<robot name='r'><link",
        "<a/>",
        "<robot name='r'/>",
        robot("<link name='l0'/><link name='l1'/>"),
        robot(links(1) + joint(1, "wobbly")),
        robot(links(1) + joint(2)),
        robot("<link name='l0'><inertial><mass value='x'/></inertial></link>"),
        robot(links(1) + joint(1, "continuous", "0 0")),
        robot(links(1) + joint(1, "revolute")),
        std::string("\0\xff\xfe", 3),
    };
    for (const std::string& text : files) {
        CAPTURE(text);
        const std::string message = refusal(text);
        CHECK_THAT(message, ContainsSubstring("r.urdf") && ContainsSubstring("expected"));
        CHECK(message.find('\n') == std::string::npos);
    }
    CHECK_THAT(refusal("<robot name='r'>\n<link"), ContainsSubstring("r.urdf:2: expected XML"));
}

TEST_CASE("a link with two parents or in a loop is rejected") {
    const std::string second = "<joint name='k' type='fixed'><parent link='l0'/><child link='l2'/></joint>";
    CHECK_THAT(refusal(robot(links(2) + joint(1) + joint(2) + second)),
               ContainsSubstring("\"l2\" is the child of joint"));
    const std::string loop = "<joint name='k' type='fixed'><parent link='l2'/><child link='l1'/></joint>";
    CHECK_THAT(refusal(robot(links(2) + joint(2) + loop), "l2"), ContainsSubstring("\"l1\" is in a loop"));
}

TEST_CASE("missing links and joints and sensors are named") {
    const std::string chain = robot(links(3) + joint(1) + joint(2, "fixed") + joint(3));
    CHECK_THAT(refusal(chain, "l9"), ContainsSubstring("expected a link \"l9\", found l0, l1, l2, l3"));
    tools::ReadRobotOptions options;
    options.tip = "l1";
    options.base = "l2";
    CHECK_THAT(refusal(chain, options), ContainsSubstring("expected link \"l1\" below link \"l2\""));
    options.base = "l1";
    options.tip = "l2";
    CHECK_THAT(refusal(chain, options),
               ContainsSubstring("expected a moving joint between link \"l1\" and link \"l2\""));
    options = {};
    options.tip = "l3";
    options.ft_joint = "j1";
    CHECK_THAT(refusal(chain, options),
               ContainsSubstring("F/T joint \"j1\"") && ContainsSubstring("found there: j2"));
    options.ft_joint.clear();
    const std::string sideways =
        "<gazebo reference='j2'><sensor type='force_torque'><force_torque>"
        "<measure_direction>sideways</measure_direction></force_torque></sensor></gazebo>";
    CHECK_THAT(refusal(robot(links(3) + joint(1) + joint(2, "fixed") + joint(3) + sideways), options),
               ContainsSubstring("\"j2\"") && ContainsSubstring("\"sideways\""));
}

TEST_CASE("joints of unsupported types are named") {
    CHECK_THAT(refusal(robot(links(1) + joint(1, "planar"))),
               ContainsSubstring("\"j1\"") && ContainsSubstring("planar"));
    CHECK_THAT(refusal(robot(links(1) + joint(1, "floating"))),
               ContainsSubstring("\"j1\"") && ContainsSubstring("floating"));
    CHECK_THAT(refusal(robot(links(1) + joint(1, "continuous", "0 0 0"))),
               ContainsSubstring("\"j1\"") && ContainsSubstring("axis"));
    CHECK_THAT(
        refusal(robot(links(2) + joint(1) + joint(2, "continuous", "0 0 1", "<mimic joint='j1'/>")), "l2"),
        ContainsSubstring("\"j2\"") && ContainsSubstring("mimics joint \"j1\""));
    std::string many = links(65);
    for (int i = 1; i <= 65; ++i) {
        many += joint(i);
    }
    CHECK(refusal(robot(many), "l64").empty());
    CHECK_THAT(refusal(robot(many), "l65"), ContainsSubstring("\"j65\"") && ContainsSubstring("at most 64"));
}
