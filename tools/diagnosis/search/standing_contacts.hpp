// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidates.hpp"
#include "tools/diagnosis/search/explanation.hpp"

#include <vector>

namespace dfdyn::tools {

/// A push at a joint that stood.
struct StandingContact {
    std::size_t joint = 0;
    ContactPulse pulse;
    /// Of the joint's torque, N·m: the push is against it, and larger by what friction takes up.
    double change = 0, change_deviation = 0;
    /// By how much friction can change it, from all of it one way to all of it the other; its deviation has
    /// what the rigid body's own change is uncertain by.
    double held = 0, held_deviation = 0;
    Eigen::VectorXd share; ///< T: what the push adds to the joint's output

    /// That friction cannot have taken up the change, by what is known of both.
    double probability() const;
    double deviation() const; ///< of their difference
};

/// Rows of joints that stand and whose output strays are in no regression (`joint_row_weight`, which
/// `signals.measured.weight` must hold): friction is anything there. But not everything: a joint that stands
/// without being touched changes its torque by at most twice its dry friction, beside what moves the rest of
/// the arm. These are the pulses that are more, both in what the rigid body misses of `measured` (T x m) and
/// in what the explanation leaves of that, `rest` (T x m): a cause that was found while the joint moved may
/// say anything of it while it stands. A push that stays is none: a step is what friction leaves, too. Where
/// no dry friction of the joint is known, by four of its deviations, nothing is said. Friction is taken to
/// hold no more than it does while sliding, unless a static one was found. None for a wrench. Cost: 8 T
/// products per length of a push, and a fit of each shape of each cause at a joint.
std::vector<StandingContact> standing_contacts(const DiagnosisSignals& signals,
                                               const Explanation& explanation,
                                               const Eigen::MatrixXd& measured, const Eigen::MatrixXd& rest);

} // namespace dfdyn::tools
