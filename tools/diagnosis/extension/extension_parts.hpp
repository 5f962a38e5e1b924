// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/extension/extension.hpp"
#include "tools/diagnosis/signals/signals.hpp"
#include "tools/model/effects.hpp"

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

/// A column of `kind` on the effect's output, with the direction of motion as uncertain as the diagnosis took
/// it.
EffectModel on_joint(const ChosenEffect& chosen, const EffectKind& kind);

/// Adds a column, or its value to that of the same one. Coefficients go on adapting: they may be a tenth off,
/// however well the recording determined them.
void add_column(Extension& extension, const EffectModel& effect, double value, double deviation);

/// The same with one of the effect's coefficients.
void add_column(Extension& extension, const ChosenEffect& chosen, const EffectModel& effect,
                Eigen::Index coefficient);

/// The same with its first coefficient, as a column of `kind`.
EffectDisposition add_single(Extension& extension, const ChosenEffect& chosen, const EffectKind& kind);

/// A gain of an actuator or a sensor's axis: it multiplies all that the model has on that output.
EffectDisposition add_gain(Extension& extension, const ChosenEffect& chosen);

/// Multiplies what the rigid body gives on an output. `effects_too`: its columns as well; otherwise they stay
/// what they are.
void scale_output(Extension& extension, Eigen::Index output, double factor, bool effects_too);

/// Into the order of the physics' columns.
void sort_columns(Extension& extension);

} // namespace dfdyn::tools
