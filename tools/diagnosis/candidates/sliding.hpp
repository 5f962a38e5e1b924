// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate_parts.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// The signals from which the effects of one joint are computed; velocity and direction: per row.
struct JointSignals {
    const DiagnosisSignals& all;
    std::string where;
    Eigen::Index output;
    Eigen::VectorXd position, velocity, direction;

    JointSignals(const DiagnosisSignals& signals, std::size_t joint);

    Candidate candidate() const {
        Candidate result;
        result.where = where;
        return result;
    }
    EffectColumn column(Eigen::VectorXd series) const { return on_output(output, std::move(series)); }
};

/// Dahl friction (P. R. Dahl, "A solid friction model", 1968): df/dq = (1 - f sgn q' / level) / distance. It
/// builds up to `level` (T) over `distance` (rad) where the level is 1, and with the same stiffness
/// elsewhere. The integration is exact for steps with constant direction.
Eigen::VectorXd dahl(const JointSignals& joint, double distance, const Eigen::VectorXd& level);

/// Dahl friction with a level of 1.
Eigen::VectorXd dahl(const JointSignals& joint, double distance);

/// rad; friction that builds up over a shorter distance is Coulomb friction
inline constexpr double shortest_presliding = 3e-3;

/// Returns the direction of sliding of a joint for columns 0 to 2 of Coulomb and Stribeck friction: from its
/// velocity, or from its travel, which keeps the direction during standstill.
std::vector<Eigen::VectorXd> sliding_directions(const JointSignals& joint);

/// Returns the family of the friction models of one joint. At most one of them is chosen.
inline std::string sliding_family(const JointSignals& joint) { return "sliding at " + joint.where; }

} // namespace dfdyn::tools
