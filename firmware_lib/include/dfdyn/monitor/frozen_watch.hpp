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
/// repeats usually, while others move. A joint that comes to rest repeats too, but it slows down before; so a
/// position counts only if it stopped dead: its last steps before the run were at least `dead` of its usual
/// ones. And a run counts only if it is half as long again as the longest before. Where no position changes,
/// nothing is learned and no run goes on. Memory: 9 numbers per channel.
template <class Scalar, int count>
class FrozenWatch {
  public:
    static constexpr Scalar memory = 5000;      ///< samples, of what is usual
    static constexpr Scalar dead = Scalar(0.3); ///< of the usual step
    static constexpr Scalar least_trials = 500; ///< samples, before anything is known of what is usual
    static constexpr int steps = 5;             ///< just before, that are averaged
    static constexpr int cost = 8;              ///< multiply-adds per channel of `add`, at most

    FrozenWatch(Extent<count> channels, int joints) noexcept
        : channels_(channels), joints_(joints), states_(States::zeros(channels)) {}

    void restart() noexcept { samples_ = 0; }

    /// The readings of one instant: `joints` positions, then the rest.
    void add(const Scalar* positions, const Scalar* others) noexcept {
        int moving = 0;
        for (int c = 0; c < joints_; ++c) {
            moving += samples_ > 0 && positions[c] != states_[c].last ? 1 : 0;
        }
        for (int c = 0; c < channels_; ++c) {
            const Scalar value = c < joints_ ? positions[c] : others[c - joints_];
            State& state = states_[c];
            if (samples_ > 0) {
                const bool repeated = value == state.last;
                const int rest = moving - (c < joints_ && !repeated ? 1 : 0);
                observe(state, std::abs(value - state.last), repeated, rest > 0);
            }
            state.last = value;
        }
        samples_ = 1;
    }

    /// log of the odds against chance of the channel's present run; 0 if it came to rest by itself.
    [[nodiscard]] Scalar evidence(int channel) const noexcept {
        const State& state = states_[channel];
        const bool came_to_rest = channel < joints_ && state.step_before < dead * state.usual_step;
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
        Scalar recent_step, usual_step, step_before; ///< mean magnitudes
        Scalar repeats, trials;                      ///< while others move
        Scalar moves;                                ///< samples that differ from the one before
        int run, longest;                            ///< of repeats: the present one, those before
    };
    using States = Storage<State, count>;

    /// One step counts at most so many usual ones, once those are known.
    static constexpr Scalar outlier = 100;

    static void observe(State& state, Scalar whole_step, bool repeated, bool others_move) noexcept {
        const bool known = state.moves >= 10 * steps;
        const Scalar most = known ? outlier * state.usual_step : std::numeric_limits<Scalar>::max() / memory;
        const Scalar step = std::min(most, whole_step);
        if (!repeated) {
            state.longest = std::max(state.longest, state.run);
            state.run = 0;
            state.recent_step += (step - state.recent_step) / steps;
        } else if (others_move) {
            state.step_before = state.run == 0 ? state.recent_step : state.step_before;
            state.run = std::min(state.run + 1, 1 << 20);
            state.recent_step += (step - state.recent_step) / steps;
        }
        if (others_move) {
            const Scalar keep = state.trials < memory ? Scalar(1) : 1 - 1 / memory;
            state.trials = keep * state.trials + 1;
            state.repeats = keep * state.repeats + (repeated ? 1 : 0);
        }
        if (!repeated) {
            state.moves = std::min(state.moves + 1, memory);
            state.usual_step += (step - state.usual_step) / state.moves;
        }
    }

    [[no_unique_address]] Extent<count> channels_;
    int joints_;
    States states_;
    int samples_ = 0;
};

} // namespace dfdyn
