// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"
#include "tools/diagnosis/effects/effect.hpp"
#include "tools/model/model.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace dfdyn::tools {

/// A column of the physics beside the rigid body: what its coefficient is, and how far it may be off.
struct ExtensionColumn {
    EffectModel effect;
    double value = 0, deviation = 0; ///< in the unit of the effect's parameter
};

/// How the extended model has a finding.
struct CarriedFinding {
    using How = EffectDisposition;
    std::string effect, where;
    How how = How::left_out;
};

/// A robot's rigid body with what a diagnosis found, as a parametric model holds it.
struct Extension {
    Robot robot; ///< with the geometry, gravity and sensor frame that were found
    OutputKind kind = OutputKind::joint_torque;
    Eigen::VectorXd bodies;               ///< ten inertial parameters per body
    std::vector<ExtensionColumn> columns; ///< in the order of the physics' columns
    Eigen::VectorXd output_gain;          ///< output per N·m (N)
    std::vector<CarriedFinding> carried;  ///< a line per chosen effect

    /// The parameters of `linkK` of the robot; `link`: from 0.
    auto body(Eigen::Index link) {
        const Eigen::Index beyond = static_cast<Eigen::Index>(robot.joints.size()) - link;
        return bodies.segment<10>(bodies.size() - 10 * beyond);
    }
};

/// The robot as its file says, without any effect.
Extension nominal_extension(const DiagnosisWork& work);

/// With every effect that the diagnosis chose, and its masses where those are uncertain.
Extension extension_of(const DiagnosisWork& work);

/// The nominal robot with the columns of `extension`, which know nothing yet: they start at zero with the
/// deviation that the whole of what was found would have.
Extension names_only(const DiagnosisWork& work, const Extension& extension);

} // namespace dfdyn::tools
