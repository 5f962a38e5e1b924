// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates.hpp"
#include "tools/diagnosis/explanation.hpp"

#include <vector>

namespace dfdyn::tools {

/// A push at a joint that stood.
struct StandingContact {
    std::size_t joint = 0;
    ContactPulse pulse;
    double change = 0, change_deviation = 0; ///< of the joint's torque, N·m
    /// By how much friction can change it, from all of it one way to all of it the other; its deviation has
    /// what the rigid body's own change is uncertain by.
    double held = 0, held_deviation = 0;
    Eigen::VectorXd share; ///< T: what the push adds to the joint's output

    /// That friction cannot have taken up the change, by what is known of both.
    double probability() const;
};

/// Rows of joints that stand and whose output strays are in no regression (`joint_row_weight`): friction is
/// anything there. But not everything: a joint that stands without being touched changes its torque by at
/// most twice its dry friction, beside what moves the rest of the arm. These are the pulses that are more,
/// both in what the rigid body misses of `measured` (T x m) and in what the explanation leaves of that: a
/// cause that was found while the joint moved may say anything of it while it stands. Where no dry friction
/// of the joint is known nothing is said. None for a wrench. Cost: T times the rows of all pushes' lengths.
std::vector<StandingContact> standing_contacts(const DiagnosisSignals& signals,
                                               const Explanation& explanation,
                                               const Eigen::MatrixXd& measured);

} // namespace dfdyn::tools
