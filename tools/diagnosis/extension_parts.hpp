// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidate.hpp"
#include "tools/diagnosis/extension.hpp"
#include "tools/diagnosis/signals.hpp"

namespace dfdyn::tools {

/// An effect that the diagnosis chose, with its coefficients and their standard deviations.
struct ChosenEffect {
    const DiagnosisSignals& signals;
    const Candidate& candidate;
    const EffectShape& shape;
    const Eigen::VectorXd& coefficients;
    const Eigen::VectorXd& deviations;

    Eigen::Index output() const; ///< of the first column in use
    Eigen::Index number() const; ///< of `jointK`, `linkK`, …: from 0
};

// Each adds one effect to the model and says how.
CarriedFinding::How add_viscous(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_coulomb(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_stribeck(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_presliding(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_offset(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_rotor(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_spring(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_ripple(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_bias(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_gain(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_payload(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_link_error(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_tilt(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_encoder_offset(Extension& extension, const ChosenEffect& chosen);
CarriedFinding::How add_rotation(Extension& extension, const ChosenEffect& chosen);

/// Multiplies what the rigid body gives on an output. `effects_too`: its columns as well; otherwise they stay
/// what they are.
void scale_output(Extension& extension, Eigen::Index output, double factor, bool effects_too);

/// Into the order of the physics' columns.
void sort_columns(Extension& extension);

} // namespace dfdyn::tools
