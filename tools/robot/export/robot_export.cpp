// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/export/robot_export.hpp"

#include "tools/base/text/number.hpp"

namespace dfdyn::tools {

const std::vector<RobotFormat>& robot_formats() {
    static const std::vector<RobotFormat> formats{{"urdf", "corrected_robot.urdf", urdf_text, false},
                                                  {"mjcf", "corrected_robot.xml", mjcf_text, true},
                                                  {"json", "corrected_robot.json", robot_json_text, true}};
    return formats;
}

std::string spaced(const Eigen::VectorXd& values) {
    std::string text;
    for (const double value : values) {
        text.append(text.empty() ? "" : " ").append(number_text(value));
    }
    return text;
}

} // namespace dfdyn::tools
