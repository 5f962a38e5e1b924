// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/model/model.hpp"
#include "tools/replay/replay.hpp"

#include <span>
#include <vector>

namespace dfdyn::tools {

/// A stretch in which the measurement contradicted the model: a contact, a collision, a sensor fault.
struct Contradiction {
    double start_s, end_s; ///< of the recording's own time
    double peak;           ///< the largest normalised innovation squared
};

/// The stretches of `replayed` whose normalised innovation squared exceeds `limit`; less than a quarter of a
/// second apart counts as one, less than two ticks as none.
std::vector<Contradiction> find_contradictions(const ReplayedRecording& replayed, double limit);

/// Sets the model's limit of the normalised innovation squared from its training rows, each half by an
/// estimator that has learned the other half, from nothing or (`from_prior` false) from the model's own
/// start: three times the value that 99.9 % of the innovations of a half do not exceed, of the half in which
/// it is larger. Residuals of a real arm are neither white nor Gaussian, so a chi-square bound would refuse
/// good samples. The patience becomes one and a half seconds. Cost: two ticks a row.
void calibrate_innovation_limit(TrainedModel& model, std::span<const Recording> recordings,
                                bool from_prior = true);

} // namespace dfdyn::tools
