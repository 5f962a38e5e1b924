// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn {

/// Detects frozen sensors: readings that repeat exactly while other joints move. `count` channels, the
/// positions of the joints first.
///
/// The evidence of a frozen channel is the length of its run of repeats times log(1 / p). Here p is the usual
/// frequency of a repeat while other joints move. Two kinds of runs are no evidence:
/// - a run of a position whose joint had slowed down before, as when it comes to rest;
/// - a run shorter than 1.5 times the longest earlier run.
///
/// A joint counts as moving if the mean of its recent steps is at least `dead` times the usual step and
/// `dither` quantisation steps: feedback makes the positions of a stationary arm tremble. The usual step is
/// the mean step weighted by the steps, so that minutes of tremble contribute little. A run does not grow
/// while no other joint moves. Memory: 11 numbers per channel.
template <class Scalar, int count>
class FrozenWatch {
  public:
    static constexpr Scalar memory = 5000;       ///< samples, of the usual values
    static constexpr Scalar dead = Scalar(0.25); ///< share of the usual step
    static constexpr Scalar dither = 2;          ///< quantisation steps per sample of a stationary joint
    /// Usual steps; larger ones are clamped once the usual step is known.
    static constexpr Scalar outlier = 20;
    static constexpr Scalar least_trials = 500; ///< samples before the frequency of repeats is known
    static constexpr int steps = 5;             ///< memory of the mean of the recent steps
    static constexpr int cost = 14;             ///< maximum multiply-adds of `add` per channel

    FrozenWatch(Extent<count> channels, int joints) noexcept
        : channels_(channels), joints_(joints), states_(States::zeros(channels)) {}

    void restart() noexcept { samples_ = 0; }

    /// Adds the readings of one sample: `joints` positions, and `count` - `joints` other channels.
    void add(const Scalar* positions, const Scalar* others) noexcept {
        int moving = 0;
        bool changed = false;
        for (int c = 0; c < joints_; ++c) {
            State& state = states_[c];
            changed = changed || positions[c] != state.last;
            state.moves = state.distance > 0 && state.recent_step >= least_step(state);
            moving += state.moves ? 1 : 0;
        }
        for (int c = 0; c < channels_; ++c) {
            const Scalar value = c < joints_ ? positions[c] : others[c - joints_];
            State& state = states_[c];
            if (samples_ > 0 && changed) {
                const bool others_move = moving > (state.moves ? 1 : 0);
                observe(state, std::abs(value - state.last), value == state.last, others_move);
            }
            state.last = value;
        }
        samples_ = 1;
    }

    /// Returns the log odds of the channel's run against chance, ≥ 0; 0 if the joint came to rest by itself.
    [[nodiscard]] Scalar evidence(int channel) const noexcept {
        const State& state = states_[channel];
        const bool came_to_rest = channel < joints_ && state.step_before < least_step(state);
        const bool as_before = 2 * state.run < 3 * state.longest;
        if (came_to_rest || as_before || state.trials < least_trials) {
            return 0;
        }
        const Scalar often = (state.repeats + 1) / (state.trials + 2);
        return static_cast<Scalar>(state.run) * -std::log(std::min(often, Scalar(1)));
    }

    [[nodiscard]] int run(int channel) const noexcept { return states_[channel].run; }
    [[nodiscard]] int channels() const noexcept { return channels_; }

  private:
    struct State {
        Scalar last;
        Scalar recent_step, step_before; ///< mean magnitudes
        Scalar usual_step;               ///< mean magnitude with the steps as weights
        Scalar distance;                 ///< sum of the steps, at most `memory` usual ones
        Scalar quantum;                  ///< smallest step so far, 0 before the first
        Scalar repeats, trials;          ///< while other joints move
        int changes;                     ///< samples that differ from the one before; at most 50
        int run, longest;                ///< repeats: of the present run, of the longest one before
        bool moves;                      ///< joints only
    };
    using States = Storage<State, count>;

    /// Returns the smallest mean step of a moving joint.
    static Scalar least_step(const State& state) noexcept {
        return std::max(dead * state.usual_step, dither * state.quantum);
    }

    static void observe(State& state, Scalar whole_step, bool repeated, bool others_move) noexcept {
        constexpr int known = 10 * steps;
        const Scalar most =
            state.changes < known ? std::numeric_limits<Scalar>::max() / memory : outlier * state.usual_step;
        const Scalar step = std::min(most, whole_step);
        if (!repeated) {
            state.longest = std::max(state.longest, state.run);
            state.run = 0;
            state.changes = std::min(state.changes + 1, known);
            state.quantum = state.quantum > 0 ? std::min(state.quantum, step) : step;
            state.distance = std::min(state.distance, memory * state.usual_step) + step;
            state.usual_step += step / state.distance * (step - state.usual_step);
        } else if (others_move) {
            state.step_before = state.run == 0 ? state.recent_step : state.step_before;
            state.run = std::min(state.run + 1, 1 << 20);
        }
        state.recent_step += (step - state.recent_step) / steps;
        if (others_move) {
            const Scalar keep = state.trials < memory ? Scalar(1) : 1 - 1 / memory;
            state.trials = keep * state.trials + 1;
            state.repeats = keep * state.repeats + (repeated ? 1 : 0);
        }
    }

    [[no_unique_address]] Extent<count> channels_;
    int joints_;
    States states_;
    int samples_ = 0;
};

} // namespace dfdyn
