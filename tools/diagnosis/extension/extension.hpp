// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"
#include "tools/diagnosis/effects/effect.hpp"
#include "tools/model/model.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace dfdyn::tools {

/// A column of the physics in addition to the rigid body: the value and the prior standard deviation of its
/// coefficient.
struct ExtensionColumn {
    EffectModel effect;
    double value = 0, deviation = 0; ///< in the unit of the effect's parameter
};

/// Representation of a finding in the extended model.
struct ExtendedFinding {
    using How = EffectDisposition;
    std::string effect, where;
    How how = How::left_out;
};

/// A robot's rigid body and the findings of a diagnosis, as a parametric model represents them.
struct ModelExtension {
    Robot robot; ///< with the estimated geometry, gravity and sensor frame
    OutputKind kind = OutputKind::joint_torque;
    Eigen::VectorXd bodies;               ///< ten inertial parameters per body
    std::vector<ExtensionColumn> columns; ///< in the order of the physics' columns
    Eigen::VectorXd output_gain;          ///< output per N·m (N)
    std::vector<ExtendedFinding> carried; ///< one per chosen effect
    /// m: the rigid body's factor in plain least squares, which `output_gain` contains and by which the
    /// output's columns are divided; 1 where the causes are the model
    Eigen::VectorXd least_squares_gain;

    /// Returns the ten parameters of a link. `link`: from 0.
    auto body(Eigen::Index link) {
        const Eigen::Index beyond = static_cast<Eigen::Index>(robot.joints.size()) - link;
        return bodies.segment<10>(bodies.size() - 10 * beyond);
    }
};

/// Returns the robot as described in its file, without effects.
ModelExtension nominal_extension(const DiagnosisWork& work);

/// Returns the robot with every effect that the diagnosis chose, and with the estimated masses if masses are
/// uncertain.
ModelExtension extension_of(const DiagnosisWork& work);

/// Returns the nominal robot with the columns of `extension`, without their estimated values. Each
/// coefficient starts at zero, with the standard deviation of the complete effect.
ModelExtension names_only(const DiagnosisWork& work, const ModelExtension& extension);

} // namespace dfdyn::tools
