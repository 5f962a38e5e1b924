// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate_parts.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// What the effects of one joint are made of; velocity, direction: per row.
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

/// Dahl's friction that builds up to `level` (T) over `distance` (rad) where that is 1, by the same stiffness
/// where it is not: df/dq = (1 - f sgn q' / level) / distance, exact for steps of constant direction (P. R.
/// Dahl, "A solid friction model", 1968).
Eigen::VectorXd dahl(const JointSignals& joint, double distance, const Eigen::VectorXd& level);

/// The same for a level of 1.
Eigen::VectorXd dahl(const JointSignals& joint, double distance);

inline constexpr double shortest_presliding =
    3e-3; // rad; what builds up over less is called Coulomb friction

/// Which way a joint slides, in columns 0 to 2 of Coulomb's and Stribeck's friction: by its velocity, or by
/// its travel, which keeps the direction where the joint stands.
std::vector<Eigen::VectorXd> sliding_directions(const JointSignals& joint);

/// Effects of one family are different models of the same sliding: at most one of them is chosen.
inline std::string sliding_family(const JointSignals& joint) { return "sliding at " + joint.where; }

} // namespace dfdyn::tools
