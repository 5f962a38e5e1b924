// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/model/model.hpp"
#include "tools/replay/replay.hpp"

#include <span>
#include <vector>

namespace dfdyn::tools {

/// A time interval in which the measurement contradicted the model: a contact, a collision, a sensor fault.
struct Contradiction {
    double start_s, end_s; ///< time of the recording
    double peak;           ///< the largest normalised innovation squared
};

/// Returns the intervals of `replayed` in which the normalised innovation squared exceeds `limit`. Intervals
/// with less than a quarter of a second between them are merged; intervals of less than two ticks are
/// ignored.
std::vector<Contradiction> find_contradictions(const ReplayedRecording& replayed, double limit);

/// Sets the model's limit of the normalised innovation squared from its training rows. Two-fold
/// cross-validation: an estimator that has learned one half of the rows evaluates the other half. It starts
/// from the prior or (`from_prior` false) from the model's initial state. The limit is three times the
/// largest of the halves' 99.9 % quantiles of the innovations and of the chi-square quantile. The latter
/// alone would reject good samples, because real residuals are neither white nor Gaussian. Without it the
/// halves of a short recording may not show how far the next motion is from both. The patience is set to 1.5
/// s. Cost: two ticks per row.
void calibrate_innovation_limit(TrainedModel& model, std::span<const Recording> recordings,
                                bool from_prior = true);

} // namespace dfdyn::tools
