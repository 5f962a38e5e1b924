// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"

#include <Eigen/Geometry>

namespace dfdyn::tools {

namespace {

constexpr ParameterKind tilt_about_x{"tilt_x", "rad"};
constexpr ParameterKind tilt_about_y{"tilt_y", "rad"};

/// Gravity in the frame of a base that is turned by +x, then by +y.
Eigen::Vector3d tilted_gravity(const Eigen::Vector3d& gravity, double x, double y) {
    return Eigen::AngleAxisd(-x, Eigen::Vector3d::UnitX()) *
           (Eigen::AngleAxisd(-y, Eigen::Vector3d::UnitY()) * gravity);
}

Eigen::MatrixXd tilted_outputs(const DiagnosisSignals& signals, double x, double y) {
    Robot robot = signals.robot;
    robot.gravity = tilted_gravity(robot.gravity, x, y);
    return rigid_outputs(robot, signals.kind, signals.measured.motion);
}

/// Linearized about a tilt by x and y. With these angles as coefficients, the sum of the columns is exact.
Candidate tilt_candidate(const DiagnosisSignals& signals, double x, double y) {
    Candidate result;
    result.where = "base";
    const double along_x = at_least_small(x);
    const double along_y = at_least_small(y);
    const Eigen::MatrixXd first = tilted_outputs(signals, 0, along_y);
    result.columns = {on_outputs((tilted_outputs(signals, along_x, along_y) - first) / along_x),
                      on_outputs((first - signals.nominal) / along_y)};
    result.shapes = {whole_shape(result, up_to(0.6))};
    result.relinearized_at = [&signals](const EffectShape&, const Eigen::VectorXd& coefficients) {
        return tilt_candidate(signals, coefficients[0], coefficients[1]);
    };
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector{tilt_about_x.at(coefficients[0]), tilt_about_y.at(coefficients[1])};
    };
    return result;
}

} // namespace

Effect effects::gravity_tilt() {
    return {.name = "gravity_tilt",
            .where = "base",
            .parameters = {tilt_about_x, tilt_about_y},
            .evidence = "is that of a gravity that points elsewhere",
            .experiment = "put a level on the base; or repeat a static pose after turning the first joint by "
                          "half a turn",
            .in_extended_model = "constant",
            .each = Each::arm,
            .candidates = [](const DiagnosisSignals& signals,
                             std::size_t) { return std::vector{tilt_candidate(signals, 0, 0)}; },
            .extend =
                [](ModelExtension& extension, const ChosenEffect& chosen) {
                    extension.robot.gravity = tilted_gravity(extension.robot.gravity, chosen.coefficients[0],
                                                             chosen.coefficients[1]);
                    return EffectDisposition::fixed;
                }};
}

} // namespace dfdyn::tools
