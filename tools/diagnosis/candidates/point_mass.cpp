// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/point_mass.hpp"

#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/robot/firmware_chain.hpp"

namespace dfdyn::tools {

namespace {

/// Change of the inertial parameters of 1 kg at `centre` if its first moment changes by 1 kg·m along `axis`
/// and its mass remains.
InertialParameters first_moment(const Eigen::Vector3d& centre, Eigen::Index axis) {
    constexpr double step = 1e-4; // m: small enough for linearity
    const Eigen::Vector3d shift = step * Eigen::Vector3d::Unit(axis);
    return (point_mass(1, centre + shift) - point_mass(1, centre - shift)) / (2 * step);
}

} // namespace

InertialParameters point_mass(double mass, const Eigen::Vector3d& centre) {
    return body_parameters(mass, centre, Eigen::Matrix3d::Zero());
}

std::vector<EffectColumn> mass_columns(const DiagnosisSignals& signals, Eigen::Index body,
                                       const Eigen::Vector3d& centre, const Eigen::Isometry3d& placement,
                                       const Eigen::Vector3d& displacement) {
    const Eigen::Vector3d midpoint = centre + displacement / 2; // the slope here is that of the secant
    std::vector<EffectColumn> columns{
        on_outputs(signals.of_body(body, moved(point_mass(1, centre), placement)))};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        columns.push_back(on_outputs(signals.of_body(body, moved(first_moment(midpoint, axis), placement))));
    }
    return columns;
}

} // namespace dfdyn::tools
