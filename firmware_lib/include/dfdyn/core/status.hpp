// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <cstdint>

namespace dfdyn {

/// Reason why a tick did not predict or did not learn. Below 32: limits; the data are valid. From 32: faults
/// of the sample, which was refused, or of the learned state. The numbers are stable.
enum class Reason : std::uint8_t {
    ok = 0,

    /// The lag window (the longer of features and physics) contains fewer than M+1 positions since the start,
    /// a gap or a clock restart. Remedy: wait M ticks.
    window_filling = 1,
    /// Samples were lost before this one (`SampleClock`; for a model without `period_ns`: it came later than
    /// the gap time). The window restarts with it. Remedy: find out why the bus or the scheduler lost them.
    gap = 2,
    /// Time ran backward for several consecutive samples: the new clock is adopted and the window restarts.
    clock_restarted = 3,
    /// The sample has no measured output: predicted, not learned.
    output_missing = 4,
    /// Learning of this sample has begun and continues in the next ticks, as their budget allows.
    learning_in_progress = 5,
    /// An earlier sample is still being learned, so this one is skipped. Remedy: a larger budget, or fewer
    /// features.
    learner_busy = 6,

    /// The budget was not positive: predicted, not learned.
    no_budget = 7,

    /// A `SnapshotWriter` is copying the state: predicted, not learned, until the copy is finished.
    learning_held = 8,

    /// The model predicted beyond its `prediction_limit`: the estimate is the limit, and its standard
    /// deviation is at least the distance to the model's own prediction. Learning continues. Remedy: train on
    /// a recording that contains this motion.
    prediction_bounded = 9,

    /// A position is NaN or infinite.
    position_not_finite = 32,
    /// A position exceeds the model's limit. Remedy: check the encoder and its unit (radians).
    position_out_of_range = 33,
    /// The time stamp is not later than the last one: a repeated or reordered sample.
    time_not_increasing = 34,
    /// The feature arguments or the motion are far outside the training data, for example because a position
    /// jumped within the window.
    input_out_of_range = 35,
    /// A measured output is NaN or infinite: predicted, not learned.
    output_not_finite = 36,
    /// A measured output exceeds the model's limit: predicted, not learned. Remedy: check the sensor, its
    /// range and unit.
    output_out_of_range = 37,
    /// The measurement contradicts the model far beyond the noise, as in a contact or a fault: predicted, not
    /// learned. If contradictions outnumber plausible samples by the model's patience, the arm is assumed to
    /// have changed (see `InnovationGate`).
    innovation_too_large = 38,
    /// The learned state is not finite or overflows, because constants or a snapshot contain extreme numbers.
    /// Nothing is predicted or learned. Remedy: `reset()`, or restore a valid snapshot.
    state_not_finite = 39,
};

/// One more than the largest number of a reason: the size of tables indexed by it.
inline constexpr int reason_count = 40;

/// Returns the name of a reason as written in recordings and logs.
constexpr const char* name(Reason reason) noexcept {
    switch (reason) {
    case Reason::ok:
        return "ok";
    case Reason::window_filling:
        return "window_filling";
    case Reason::gap:
        return "gap";
    case Reason::clock_restarted:
        return "clock_restarted";
    case Reason::output_missing:
        return "output_missing";
    case Reason::learning_in_progress:
        return "learning_in_progress";
    case Reason::learner_busy:
        return "learner_busy";
    case Reason::no_budget:
        return "no_budget";
    case Reason::learning_held:
        return "learning_held";
    case Reason::prediction_bounded:
        return "prediction_bounded";
    case Reason::position_not_finite:
        return "position_not_finite";
    case Reason::position_out_of_range:
        return "position_out_of_range";
    case Reason::time_not_increasing:
        return "time_not_increasing";
    case Reason::input_out_of_range:
        return "input_out_of_range";
    case Reason::output_not_finite:
        return "output_not_finite";
    case Reason::output_out_of_range:
        return "output_out_of_range";
    case Reason::innovation_too_large:
        return "innovation_too_large";
    case Reason::state_not_finite:
        return "state_not_finite";
    }
    return "unknown";
}

constexpr bool is_fault(Reason reason) noexcept { return static_cast<std::uint8_t>(reason) >= 32; }

/// Result of one tick.
struct Status {
    /// ok: the model's own prediction; prediction_bounded: its limit; any other reason: no prediction.
    Reason prediction = Reason::ok;
    Reason learning = Reason::ok; ///< ok: the sample has been learned

    /// Returns true if the estimate is the model's own prediction, within its bound.
    [[nodiscard]] constexpr bool predicted() const noexcept { return prediction == Reason::ok; }
    /// Returns true if the estimate contains a value: the model's own prediction, or its limit.
    [[nodiscard]] constexpr bool estimated() const noexcept {
        return predicted() || prediction == Reason::prediction_bounded;
    }
    /// Returns true if the sample has been learned in this tick.
    [[nodiscard]] constexpr bool learned() const noexcept { return estimated() && learning == Reason::ok; }
    /// Returns the one reason to report: the prediction's unless it is ok, otherwise learning's. A fault of
    /// the measurement takes precedence over `prediction_bounded`.
    [[nodiscard]] constexpr Reason reason() const noexcept {
        return predicted() || (estimated() && is_fault(learning)) ? learning : prediction;
    }
};

} // namespace dfdyn
