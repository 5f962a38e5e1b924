// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/storage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn {

/// Looks for readings that repeat exactly while the arm moves: `count` channels, the joints' positions first.
///
/// Evidence of a channel that is frozen: its present run of repeats times log(1 / p), where p is how often it
/// repeats usually, while other joints move. A joint that comes to rest repeats too, but it slows down
/// before; so a position counts only if it stopped dead: its last steps before the run were those of a joint
/// that moves. And a run counts only if it is half as long again as the longest before.
///
/// A joint moves if the mean of its last steps is at least `dead` of the usual one and `dither` quantisation
/// steps: feedback makes the positions of an arm that stands tremble. The usual step is a mean by distance
/// (each step weighted by itself), to which minutes of trembling contribute nothing. While no other joint
/// moves no run goes on. Memory: 11 numbers per channel.
template <class Scalar, int count>
class FrozenWatch {
  public:
    static constexpr Scalar memory = 5000;       ///< samples, of what is usual
    static constexpr Scalar dead = Scalar(0.25); ///< of the usual step
    static constexpr Scalar dither = 2;          ///< quantisation steps per sample: a joint may stand so
    /// Usual steps that one counts at most, once those are known.
    static constexpr Scalar outlier = 20;
    static constexpr Scalar least_trials = 500; ///< samples, before anything is known of what is usual
    static constexpr int steps = 5;             ///< just before, that are averaged
    static constexpr int cost = 14;             ///< multiply-adds per channel of `add`, at most

    FrozenWatch(Extent<count> channels, int joints) noexcept
        : channels_(channels), joints_(joints), states_(States::zeros(channels)) {}

    void restart() noexcept { samples_ = 0; }

    /// The readings of one instant: `joints` positions, then the rest.
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

    /// log of the odds against chance of the channel's present run; 0 if it came to rest by itself.
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
        Scalar usual_step;               ///< likewise, each step weighted by itself
        Scalar distance;                 ///< sum of the steps, at most `memory` usual ones
        Scalar quantum;                  ///< smallest step so far, 0 before the first
        Scalar repeats, trials;          ///< while others move
        int changes;                     ///< samples that differ from the one before; counted to 50
        int run, longest;                ///< of repeats: the present one, those before
        bool moves;                      ///< a joint
    };
    using States = Storage<State, count>;

    /// Of a joint that moves.
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
