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

/// Roll, pitch, yaw about the fixed axes x, y, z.
Eigen::Quaterniond sensor_rotation(double roll, double pitch, double yaw) {
    return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
}

/// Measured = rotation · true, for force and torque.
Eigen::MatrixXd turned(const Eigen::MatrixXd& wrench, const Eigen::Quaterniond& rotation) {
    const Eigen::Matrix3d matrix = rotation.toRotationMatrix();
    Eigen::MatrixXd result(wrench.rows(), 6);
    result.leftCols<3>() = wrench.leftCols<3>() * matrix.transpose();
    result.rightCols<3>() = wrench.rightCols<3>() * matrix.transpose();
    return result;
}

/// Linearized about the angles of the model. At these angles the columns add up to the exact rotation.
std::vector<Candidate> rotation_candidates(const DiagnosisSignals&, const FittedModel& model, std::size_t) {
    const Eigen::MatrixXd& wrench = model.output;
    const Eigen::Vector3d angles = model.sensor_angles.unaryExpr(&at_least_small);
    Candidate result;
    result.where = "ft_sensor";
    const std::array<Eigen::MatrixXd, 4> steps{
        turned(wrench, sensor_rotation(angles[0], angles[1], angles[2])),
        turned(wrench, sensor_rotation(0, angles[1], angles[2])),
        turned(wrench, sensor_rotation(0, 0, angles[2])), wrench};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        result.columns.push_back(
            on_outputs((steps[axis] - steps[axis + 1]) / angles[static_cast<Eigen::Index>(axis)]));
        result.shapes.push_back({{axis}, up_to(0.6), 0});
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
    const Eigen::Quaterniond rotation = sensor_rotation(angles[0], angles[1], angles[2]);
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
            .turns_sensor = true,
            .each = Each::sensor,
            .fitted_candidates = rotation_candidates,
            .extend = extend_by_rotation};
}

} // namespace dfdyn::tools
