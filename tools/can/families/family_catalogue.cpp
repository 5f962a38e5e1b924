// SPDX-License-Identifier: Apache-2.0
#include "tools/can/families/family_catalogue.hpp"

#include "tools/base/text/text.hpp"

#include <algorithm>

namespace dfdyn::tools {

/// A new family is one file in this folder, with one line here and one in its list below.
namespace families {

JointFamily icub_two_joint_board();
JointFamily icub_2foc();
JointFamily cia402();
JointFamily odrive();
JointFamily damiao();
JointFamily robstride();
JointFamily piper();
JointFamily cubemars();
JointFamily rmd();
JointFamily moteus();
JointFamily dbc_joints();

SensorFamily icub_strain();
SensorFamily robotous_rft();
SensorFamily ati_netcan();
SensorFamily dbc_sensor();

} // namespace families

const std::vector<JointFamily>& joint_families() {
    using namespace families;
    static const std::vector<JointFamily> catalogue{
        icub_two_joint_board(),
        icub_2foc(),
        cia402(),
        odrive(),
        damiao(),
        robstride(),
        piper(),
        cubemars(),
        rmd(),
        moteus(),
        dbc_joints(),
    };
    return catalogue;
}

const std::vector<SensorFamily>& sensor_families() {
    using namespace families;
    static const std::vector<SensorFamily> catalogue{
        icub_strain(),
        robotous_rft(),
        ati_netcan(),
        dbc_sensor(),
    };
    return catalogue;
}

namespace {

/// `expected`: another permitted value of `family`, or "".
template <class Family>
const Family& find_family(const JsonReader& reader, const std::vector<Family>& catalogue,
                          std::string expected) {
    const std::string name = reader.text("family");
    for (const Family& family : catalogue) {
        if (family.name == name) {
            return family;
        }
        expected += expected.empty() ? "" : &family == &catalogue.back() ? " or " : ", ";
        expected += family.name;
    }
    throw reader.error("family", expected, in_quotes(name));
}

} // namespace

const JointFamily& joint_family(const JsonReader& joints) {
    return find_family(joints, joint_families(), "");
}

const SensorFamily& sensor_family(const JsonReader& output) {
    return find_family(output, sensor_families(), "efforts");
}

} // namespace dfdyn::tools
