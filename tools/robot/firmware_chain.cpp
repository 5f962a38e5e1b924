// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/firmware_chain.hpp"

#include <algorithm>
#include <array>

namespace dfdyn::tools {

namespace {

constexpr std::array<const char*, inertial_parameters> symbols{"m",   "mcx", "mcy", "mcz", "Ixx",
                                                               "Ixy", "Ixz", "Iyy", "Iyz", "Izz"};
constexpr std::array<const char*, inertial_parameters> units{"kg",    "kg·m",  "kg·m",  "kg·m",  "kg·m²",
                                                             "kg·m²", "kg·m²", "kg·m²", "kg·m²", "kg·m²"};

std::size_t first_body(const Robot& robot, OutputKind outputs) {
    return robot.joints.size() + 1 - static_cast<std::size_t>(body_count(robot, outputs));
}

} // namespace

int body_count(const Robot& robot, OutputKind outputs) {
    if (outputs != OutputKind::wrench) {
        return static_cast<int>(robot.joints.size());
    }
    if (!robot.sensor) {
        throw std::logic_error("body_count: a wrench needs a sensor");
    }
    return static_cast<int>(std::min(robot.joints.size(), robot.joints.size() + 1 - robot.sensor->link));
}

Eigen::VectorXd nominal_parameters(const Robot& robot, OutputKind outputs) {
    const int bodies = body_count(robot, outputs);
    const std::size_t first = first_body(robot, outputs);
    Eigen::VectorXd parameters(inertial_parameters * bodies);
    for (int body = 0; body < bodies; ++body) {
        const bool cut = body == 0 && outputs == OutputKind::wrench && robot.sensor->link > 0;
        parameters.segment<inertial_parameters>(inertial_parameters * body) =
            cut ? robot.sensor->inertia_beyond
                : robot.joints[first + static_cast<std::size_t>(body) - 1].inertia;
    }
    return parameters;
}

std::vector<std::string> parameter_names(const Robot& robot, OutputKind outputs) {
    std::vector<std::string> result;
    for (std::size_t link = first_body(robot, outputs); link <= robot.joints.size(); ++link) {
        for (const char* name : symbols) {
            result.push_back("link" + std::to_string(link) + " " + name);
        }
    }
    return result;
}

std::vector<std::string> parameter_units(const Robot& robot, OutputKind outputs) {
    std::vector<std::string> result;
    for (int body = 0; body < body_count(robot, outputs); ++body) {
        result.insert(result.end(), units.begin(), units.end());
    }
    return result;
}

} // namespace dfdyn::tools
