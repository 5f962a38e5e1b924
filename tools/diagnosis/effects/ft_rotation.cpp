// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"

#include <Eigen/Geometry>

#include <array>

namespace dfdyn::tools {

namespace {

constexpr std::array sensor_angles{ParameterKind{"roll", "rad"}, ParameterKind{"pitch", "rad"},
                                   ParameterKind{"yaw", "rad"}};

/// Measured = rotation · true, for force and torque: roll, pitch, yaw about x, y, z.
std::vector<Candidate> rotation_candidates(const DiagnosisSignals&, const FittedModel& model, std::size_t) {
    const Eigen::MatrixXd& wrench = model.output;
    Candidate result;
    result.where = "ft_sensor";
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        Eigen::MatrixXd change(wrench.rows(), 6);
        for (Eigen::Index row = 0; row < wrench.rows(); ++row) {
            const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
            const Eigen::Vector3d force = wrench.row(row).head<3>();
            const Eigen::Vector3d torque = wrench.row(row).tail<3>();
            change.row(row) << unit.cross(force).transpose(), unit.cross(torque).transpose();
        }
        result.columns.push_back(on_outputs(change));
        result.shapes.push_back({{static_cast<std::size_t>(axis)}, up_to(0.6), 0});
    }
    result.shapes.push_back(whole_shape(result, up_to(0.6)));
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        std::vector<EffectParameter> values;
        for (std::size_t i = 0; i < shape.columns.size(); ++i) {
            values.push_back(sensor_angles[shape.columns[i]].at(coefficients[static_cast<Eigen::Index>(i)]));
        }
        return values;
    };
    return {std::move(result)};
}

/// Turns the model's sensor frame by the inverse rotation.
EffectDisposition extend_by_rotation(ModelExtension& extension, const ChosenEffect& chosen) {
    Eigen::Vector3d angles = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < chosen.coefficients.size(); ++i) {
        angles[static_cast<Eigen::Index>(chosen.shape.columns[static_cast<std::size_t>(i)])] =
            chosen.coefficients[i];
    }
    const Eigen::Quaterniond rotation = Eigen::AngleAxisd(angles[2], Eigen::Vector3d::UnitZ()) *
                                        Eigen::AngleAxisd(angles[1], Eigen::Vector3d::UnitY()) *
                                        Eigen::AngleAxisd(angles[0], Eigen::Vector3d::UnitX());
    extension.robot.sensor->placement.rotate(rotation.conjugate());
    return EffectDisposition::fixed;
}

} // namespace

Effect effects::ft_rotation() {
    return {.name = "ft_rotation",
            .where = "ft_sensor",
            .parameters = {sensor_angles[0], sensor_angles[1], sensor_angles[2]},
            .evidence = "is that of a sensor that is mounted turned",
            .experiment = "hang a known weight on the tool in three orientations of the sensor",
            .in_extended_model = "constant",
            .beyond_arm = true,
            .each = Each::sensor,
            .fitted_candidates = rotation_candidates,
            .extend = extend_by_rotation};
}

} // namespace dfdyn::tools
