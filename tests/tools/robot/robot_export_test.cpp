// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/export/robot_export.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/robot/urdf/read_robot.hpp"

#include <nlohmann/json.hpp>
#include <tinyxml2.h>

namespace robot_export_test {

using namespace dfdyn::tools;

RobotExport export_of_ur5() {
    RobotExport exported{dfdyn::tests::ur5(), std::vector<JointDynamics>(6), {"delay at actuator1"}};
    exported.joints[1] = {4, 8, 0.5};
    return exported;
}

TEST_CASE("an exported MJCF nests the links and holds damping and friction and armature of each joint") {
    const RobotExport exported = export_of_ur5();
    tinyxml2::XMLDocument document;
    REQUIRE(document.Parse(mjcf_text(exported).c_str()) == tinyxml2::XML_SUCCESS);
    const tinyxml2::XMLElement* body =
        document.FirstChildElement("mujoco")->FirstChildElement("worldbody")->FirstChildElement("body");
    for (std::size_t i = 0; i < 6; ++i) {
        REQUIRE(body != nullptr);
        body = body->FirstChildElement("body");
        REQUIRE(body != nullptr);
        CHECK(body->Attribute("name") == exported.robot.joints[i].link);
        const tinyxml2::XMLElement* const joint = body->FirstChildElement("joint");
        CHECK(joint->Attribute("name") == exported.robot.joints[i].name);
        CHECK(joint->DoubleAttribute("damping") == exported.joints[i].damping);
        CHECK(joint->DoubleAttribute("frictionloss") == exported.joints[i].friction);
        CHECK(joint->DoubleAttribute("armature") == exported.joints[i].armature);
        CHECK(body->FirstChildElement("inertial")->DoubleAttribute("mass") ==
              exported.robot.joints[i].inertia[0]);
    }
    CHECK(body->FirstChildElement("site")->Attribute("name") == exported.robot.tip);
}

TEST_CASE("an exported JSON holds the joints and what is left out") {
    const nlohmann::json json = nlohmann::json::parse(robot_json_text(export_of_ur5()));
    CHECK(json["schema"] == "dfdyn.robot/1");
    REQUIRE(json["joints"].size() == 6);
    CHECK(json["joints"][1]["friction"] == 8);
    CHECK(json["joints"][1]["armature"] == 0.5);
    CHECK(json["left_out"][0] == "delay at actuator1");
}

TEST_CASE("exported robots keep names with markup and leave out the inertia of links without mass") {
    RobotExport exported = export_of_ur5();
    const std::string name = "a<b & \"c\"";
    exported.robot.joints[0].name = name;
    exported.robot.joints[0].inertia.setZero();
    tinyxml2::XMLDocument mjcf;
    REQUIRE(mjcf.Parse(mjcf_text(exported).c_str()) == tinyxml2::XML_SUCCESS);
    const tinyxml2::XMLElement* const body = mjcf.FirstChildElement("mujoco")
                                                 ->FirstChildElement("worldbody")
                                                 ->FirstChildElement("body")
                                                 ->FirstChildElement("body");
    CHECK(body->FirstChildElement("joint")->Attribute("name") == name);
    CHECK(body->FirstChildElement("inertial") == nullptr);
    tinyxml2::XMLDocument urdf;
    REQUIRE(urdf.Parse(urdf_text(exported).c_str()) == tinyxml2::XML_SUCCESS);
    CHECK(urdf.FirstChildElement("robot")->FirstChildElement("joint")->Attribute("name") == name);
}

} // namespace robot_export_test
