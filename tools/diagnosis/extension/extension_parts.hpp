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

    Eigen::Index output() const; ///< output of the first column in use
    /// Returns the index of its place (`jointK`, `linkK`, …), from 0. Throws std::bad_optional_access for a
    /// place without a number.
    Eigen::Index number() const;
};

/// Returns a column of `kind` on the effect's output, with the diagnosis' uncertainty of the direction of
/// motion.
EffectModel on_joint(const ChosenEffect& chosen, const EffectKind& kind);

/// Adds a column, or adds `value` to an equal column. Coefficients continue to adapt: their prior standard
/// deviation is at least a tenth of the value, however well the recording determined them.
void add_column(ModelExtension& extension, const EffectModel& effect, double value, double deviation);

/// Adds a column for one of the effect's coefficients.
void add_column(ModelExtension& extension, const ChosenEffect& chosen, const EffectModel& effect,
                Eigen::Index coefficient);

/// Adds a column of `kind` for the effect's first coefficient.
EffectDisposition add_single(ModelExtension& extension, const ChosenEffect& chosen, const EffectKind& kind);

/// Applies the gain of an actuator or of a sensor axis. The gain multiplies everything that the model
/// predicts on that output, except effects beyond the arm (extension.cpp).
EffectDisposition add_gain(ModelExtension& extension, const ChosenEffect& chosen);

/// Multiplies the rigid body's part of an output. `effects_too`: also multiplies the output's columns.
void scale_output(ModelExtension& extension, Eigen::Index output, double factor, bool effects_too);

/// Sorts the columns into the order of the physics' columns.
void sort_columns(ModelExtension& extension);

} // namespace dfdyn::tools
