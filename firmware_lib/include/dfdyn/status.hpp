// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/strict_math.hpp"

#include <cstdint>

namespace dfdyn {

/// Why a tick did not predict, or did not learn. Below 32: limits, nothing is wrong with the data. From 32:
/// faults of the sample, which was refused. The numbers are stable.
enum class Reason : std::uint8_t {
    ok = 0,

    /// The lag window (the longer of features and physics) holds fewer than M+1 positions since the start, a
    /// gap or a clock restart. Cure: wait M ticks.
    window_filling = 1,
    /// The sample came later than the model's gap time: samples were lost, and the window restarts with this
    /// one. Cure: find out why the bus or the scheduler lost them.
    gap = 2,
    /// Time ran backward for several samples in a row: the new clock is adopted and the window restarts.
    clock_restarted = 3,
    /// The sample carries no measured output: predicted, not learned.
    output_missing = 4,
    /// Learning of this sample has begun and goes on in the next ticks, as their budget allows.
    learning_in_progress = 5,
    /// An earlier sample is still being learned: this one is skipped. Cure: a larger budget, or fewer
    /// features.
    learner_busy = 6,

    /// The budget was not positive: predicted, not learned.
    no_budget = 7,

    /// A snapshot is being copied: predicted, not learned, until it is finished (`SnapshotWriter`).
    learning_held = 8,

    /// The model predicted beyond its `prediction_limit`: the estimate holds the limit instead, and its
    /// standard deviation is at least the distance to the model's own prediction. Learning goes on. Do not
    /// feed it forward. Cure: the model does not know this motion; train on a recording of it.
    prediction_bounded = 9,

    /// A position is NaN or infinite.
    position_not_finite = 32,
    /// A position is beyond the model's limit. Cure: check the encoder and its unit (radians).
    position_out_of_range = 33,
    /// The time stamp equals the last one or is earlier: a repeated or reordered sample.
    time_not_increasing = 34,
    /// The positions give feature arguments, or a motion, far outside anything trained (a jump within the
    /// window).
    input_out_of_range = 35,
    /// A measured output is NaN or infinite: predicted, not learned.
    output_not_finite = 36,
    /// A measured output is beyond the model's limit: predicted, not learned. Cure: check the sensor, its
    /// range and unit.
    output_out_of_range = 37,
    /// The measurement contradicts the model far beyond the noise: a contact or a fault, not dynamics to
    /// learn. Predicted, not learned, until contradictions outnumber plausible samples by the model's
    /// patience; then the arm is taken to have changed (see `InnovationGate`).
    innovation_too_large = 38,
    /// What has been learned is not finite, or overflows: constants or a snapshot with absurd numbers.
    /// Nothing is predicted or learned. Cure: `reset()`, or restore a sound snapshot.
    state_not_finite = 39,
};

/// One past the largest number of a reason; sizes tables indexed by it.
inline constexpr int reason_count = 40;

/// The reason's name as written in recordings and logs ("ok" for none).
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

/// What became of one tick.
struct Status {
    /// ok: the prediction is the model's own; prediction_bounded: a limit; else there is none.
    Reason prediction = Reason::ok;
    Reason learning = Reason::ok; ///< ok: the sample has been learned

    [[nodiscard]] constexpr bool predicted() const noexcept { return prediction == Reason::ok; }
    /// Whether the estimate holds a value: the model's own prediction, or its limit.
    [[nodiscard]] constexpr bool estimated() const noexcept {
        return predicted() || prediction == Reason::prediction_bounded;
    }
    [[nodiscard]] constexpr bool learned() const noexcept { return estimated() && learning == Reason::ok; }
    /// The one reason worth reporting: of the prediction unless it is ok; but a fault of the measurement goes
    /// before a bound.
    [[nodiscard]] constexpr Reason reason() const noexcept {
        return predicted() || (estimated() && is_fault(learning)) ? learning : prediction;
    }
};

} // namespace dfdyn
