// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/contact_pulse.hpp"
#include "tools/diagnosis/search/fitted_effects.hpp"

#include <vector>

namespace dfdyn::tools {

/// A contact at a joint during standstill.
struct StationaryContact {
    std::size_t joint = 0;
    ContactPulse pulse;
    /// Change of the joint's torque (N·m). The contact acts against it and is larger by the part that
    /// friction balances.
    double change = 0, change_deviation = 0;
    /// Largest change that friction allows: from its maximum in one direction to its maximum in the other.
    /// The deviation includes the uncertainty of the rigid body's own change.
    double held = 0, held_deviation = 0;
    /// Largest change that noise makes in as many windows as were searched (N·m).
    double noise = 0;
    Eigen::VectorXd share; ///< T: contribution of the contact to the joint's output

    /// Probability that friction and noise cannot explain the change, from both uncertainties.
    double probability() const;
    double deviation() const; ///< of their difference
};

/// Returns contacts at joints during standstill.
///
/// Static friction is undetermined, so that the regression excludes rows in which a joint is stationary and
/// its output deviates from the rigid body (`joint_row_weight`, contained in `signals.measured.weight`). It
/// is bounded, however: without a contact, the torque of a stationary joint changes by at most twice its dry
/// friction, in addition to the influence of the moving links and to noise. The function returns the pulses
/// that exceed this bound in two residuals: of the rigid body for `measured` (T x m), and after the fitted
/// effects, `rest` (T x m). A cause identified during motion may be wrong during standstill.
///
/// Limits:
/// - A contact that persists is not detected, because static friction can leave a step, too.
/// - Joints whose dry friction is unknown (less than four standard deviations) have no result.
/// - More than three uncertain contacts at a joint (probability below 0.95) count as its usual deviations.
/// - Static friction is assumed equal to sliding friction unless a static level was identified.
/// - A wrench has no result.
///
/// Cost: 8 T products per pulse length, and a fit of each shape of each cause at a joint.
std::vector<StationaryContact> stationary_contacts(const DiagnosisSignals& signals,
                                                   const FittedEffects& fitted_effects,
                                                   const Eigen::MatrixXd& measured,
                                                   const Eigen::MatrixXd& rest);

} // namespace dfdyn::tools
