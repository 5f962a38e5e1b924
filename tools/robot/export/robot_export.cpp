// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/export/robot_export.hpp"

#include "tools/base/text/number.hpp"

namespace dfdyn::tools {

const std::vector<RobotFormat>& robot_formats() {
    static const std::vector<RobotFormat> formats{{"urdf", "corrected_robot.urdf", urdf_text},
                                                  {"mjcf", "corrected_robot.xml", mjcf_text},
                                                  {"json", "corrected_robot.json", robot_json_text}};
    return formats;
}

CentralBody central_body(const InertialParameters& parameters) {
    CentralBody body;
    body.mass = parameters[0];
    if (body.mass > 0) {
        body.centre = parameters.segment<3>(1) / body.mass;
    }
    body.inertia << parameters[4], parameters[5], parameters[6], parameters[5], parameters[7], parameters[8],
        parameters[6], parameters[8], parameters[9];
    body.inertia -= body.mass * (body.centre.squaredNorm() * Eigen::Matrix3d::Identity() -
                                 body.centre * body.centre.transpose());
    return body;
}

std::string spaced(const Eigen::VectorXd& values) {
    std::string text;
    for (const double value : values) {
        text.append(text.empty() ? "" : " ").append(number_text(value));
    }
    return text;
}

} // namespace dfdyn::tools
