// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/input/derivative_free_reduced.hpp"
#include "dfdyn/monitor/change_detector.hpp"
#include "dfdyn/monitor/frozen_watch.hpp"
#include "dfdyn/monitor/hypothesis_bank.hpp"
#include "dfdyn/monitor/tool_columns.hpp"

#include <type_traits>

namespace dfdyn {

/// Input of a monitor for one tick. Arrays of n or m values.
template <class Scalar>
struct Observation {
    std::int64_t time_ns;             ///< stamp of the sample
    const Scalar* position;           ///< rad, m
    const Scalar* output;             ///< measured, output units
    const Scalar* prediction;         ///< one-step-ahead prediction of the estimator
    const Scalar* standard_deviation; ///< of the output around that prediction
    const Scalar* held_prediction;    ///< with delayed weights (`DelayedWeights`)
};

/// Fault detection and isolation (FDI): detects changes of the arm or its sensors from the innovations of an
/// estimator, and estimates cause, place and size.
///
/// A `ChangeDetector` tests block means of the one-step-ahead innovations. After an alarm a `HypothesisBank`
/// fits the causes to the block means of the residuals since the onset, at most `history` blocks back.
/// Residuals are measured outputs minus `held_prediction`, because the estimator may already have learned the
/// change. The result is updated until the change is over: the innovations are as before, or `longest_blocks`
/// have passed. A `FrozenWatch` raises its own alarm for a reading that repeats beyond chance.
///
/// Use in each tick, while the learner is idle:
///
///     if (monitor.refresh_due()) {
///         regression.copy_weights(held.refresh());
///         monitor.refreshed();
///     }
///     const auto estimate = estimator.tick(sample, budget);
///     if (estimate.status.predicted() && measured) {
///         regression.predict_with(held.older(), held_means); // then to the outputs' units
///         news = monitor.tick(observation);
///     } else {
///         monitor.interrupt();
///     }
///
/// Cost per tick: at most `cost()`, at the end of a block during a change; otherwise a fraction of it. No
/// heap. Memory: about 13 m `history` + 260 m scalars, see `sizeof`.
template <class Scalar, class Arm, int M, int history = 48>
class Monitor {
  public:
    static constexpr int n = Arm::joints;       ///< joints
    static constexpr int m = Arm::outputs;      ///< outputs
    using Change = dfdyn::Change<Scalar, m>;    ///< a change with its most probable cause
    using Motion = DerivativeFreeReduced<M, 3>; ///< position, velocity and acceleration from the window

    /// Geometry, time scales and the false-alarm rate. Must outlive the monitor.
    struct Constants {
        [[no_unique_address]] typename Arm::Sizes sizes;       ///< numbers of joints, outputs and bodies
        [[no_unique_address]] Extent<M> lags;                  ///< of the window of positions, even
        typename Arm::template Constants<Scalar> chain;        ///< geometry of the arm
        typename Motion::template Constants<Scalar, n> motion; ///< `centred_motion_rows` in difference form
        Storage<Scalar, m> output_gain;     ///< output per N·m or N: 1, or 1 / torque constant (A/N·m)
        Scalar tip[3];                      ///< m, point of a force on the tool, in the last link's frame
        Scalar sign_velocity;               ///< rad/s, v of the sign of friction tanh(q̇ / v)
        SpeedClasses<Scalar> speed;         ///< upper bounds of "stationary" and "creeping"
        std::int32_t block_samples;         ///< about 0.1 s
        Scalar blocks_between_false_alarms; ///< mean distance, all outputs together
        std::int32_t report_blocks;         ///< from the onset to the first report, about 2 s
        std::int32_t longest_blocks;        ///< largest duration of a change, about 20 s
        std::int32_t refresh_blocks;        ///< refresh period of the delayed weights, about 3 s
    };

    static constexpr int catch_up = 3; ///< stored blocks that the bank adds per new block
    /// Bound of innovations and residuals, in predicted deviations. A clamped spike cannot overflow a square
    /// or dominate a mean over later blocks. A lasting deviation of this size still raises an alarm.
    static constexpr Scalar largest_deviation = 1000;
    /// Smallest usual scale of a block's innovation, as a share of that of white innovations with the
    /// predicted deviation. A deviation that the estimator overestimates, as after a standstill, then is no
    /// evidence.
    static constexpr Scalar least_scale = Scalar(0.25);
    static constexpr Scalar largest_position = 10'000; ///< rad, m; a larger position counts as a gap

    explicit Monitor(const Constants&&) = delete; // it would refer to a temporary
    /// Starts without a change. Refers to `constants`.
    explicit Monitor(const Constants& constants) noexcept
        : constants_(&constants), motion_(constants.motion, constants.sizes.joint_count, constants.lags, {}),
          innovations_(constants.sizes.output_count, constants.lags),
          residuals_(constants.sizes.output_count, constants.lags),
          screws_(Storage<Screw<Scalar>, m>::zeros(constants.sizes.output_count)),
          xi_(Inputs::zeros(extent<product(3, n)>(3 * joints()))),
          payload_(Storage<Scalar, product(payload_columns, m)>::zeros(
              extent<product(payload_columns, m)>(payload_columns * outputs()))),
          force_(Storage<Scalar, product(force_columns, m)>::zeros(
              extent<product(force_columns, m)>(force_columns * outputs()))),
          scaled_(Outputs::zeros(constants.sizes.output_count)), deviations_(scaled_),
          block_(Storage<OutputBlock<Scalar>, m>::zeros(constants.sizes.output_count)),
          past_(Past::zeros(extent<product(history, m)>(history * outputs()))),
          detector_(constants.sizes.output_count, torques, constants.blocks_between_false_alarms,
                    least_scale / std::sqrt(static_cast<Scalar>(constants.block_samples))),
          bank_(constants.sizes.output_count, torques),
          frozen_(extent<sum(n, m)>(joints() + outputs()), joints()),
          repeats_limit_(2 * std::log(constants.blocks_between_false_alarms *
                                      static_cast<Scalar>(joints() + outputs()))) {
        change_.bias = Outputs::zeros(constants.sizes.output_count);
        since_refresh_ = 2 * constants.refresh_blocks;
    }

    /// Processes one tick. Values that are not finite or an absurd position count as a gap. Returns true if
    /// `change()` is new, has another cause, or is over.
    bool tick(const Observation<Scalar>& observation) noexcept {
        if (!usable(observation)) {
            interrupt();
            return false;
        }
        frozen_.add(observation.position, observation.output);
        push(observation);
        if (!motion_.ready() || !residuals_.full()) {
            return false;
        }
        motion_.evaluate(xi_.data());
        if (samples_ == constants_->block_samples / 2) {
            take_tool_columns();
        }
        accumulate();
        if (++samples_ < constants_->block_samples) {
            return false;
        }
        end_block(observation.time_ns);
        return take_in(observation.time_ns);
    }

    /// Reports a gap: nothing was measured, or samples are missing. Windows and the current block restart.
    void interrupt() noexcept {
        motion_.restart();
        innovations_.restart();
        residuals_.restart();
        frozen_.restart();
        drop_block();
        follows_ = false;
    }

    /// Starts another recording or motion: a gap that also ends a present change without a further report.
    void restart() noexcept {
        interrupt();
        detector_.restart();
        changing_ = false;
        since_refresh_ = 2 * constants_->refresh_blocks;
    }

    /// Returns true if the delayed weights are due for a refresh; call `refreshed` after it. Both copies are
    /// due at the start and after a change, so that none is from before.
    [[nodiscard]] bool refresh_due() const noexcept {
        return !changing_ && since_refresh_ >= constants_->refresh_blocks;
    }
    /// Registers that the delayed weights have been refreshed.
    void refreshed() noexcept { since_refresh_ -= constants_->refresh_blocks; }

    /// Returns true from an alarm until the change is over.
    [[nodiscard]] bool changing() const noexcept { return changing_; }
    /// Returns the last change. Its cause is valid after `tick` has returned true.
    [[nodiscard]] const Change& change() const noexcept { return change_; }

    /// Returns the largest cost of a tick, in multiply-adds: at the end of a block during a change.
    [[nodiscard]] static constexpr std::int64_t cost(const typename Arm::Sizes& sizes, int lags) noexcept {
        const int joints = sizes.joint_count;
        const int outputs = sizes.output_count;
        const std::int64_t tick =
            Motion::template Map<Scalar, n>::cost(joints, lags, 3) + tool_columns_cost(joints, outputs) +
            FrozenWatch<Scalar, 1>::cost * (joints + outputs) + std::int64_t{outputs} * (function_cost + 30);
        using Bank = HypothesisBank<Scalar, m>;
        return tick + ChangeDetector<Scalar, m>::cost(outputs) + catch_up * Bank::cost_of_add(outputs) +
               std::max(Bank::cost_of_start(outputs, history), Bank::cost_of_judge(outputs));
    }

  private:
    static constexpr bool torques = std::is_same_v<typename Arm::Output, JointTorques>;
    using Inputs = Storage<Scalar, product(3, n)>;
    using Outputs = Storage<Scalar, m>;
    using Past = Storage<OutputBlock<Scalar>, product(history, m)>;

    /// Adapts a plain array to the interface of the window of positions.
    struct Positions {
        const Scalar* values;
        [[nodiscard]] const Scalar* data() const noexcept { return values; }
    };
    struct Pose {
        Positions position;
    };

    [[nodiscard]] int joints() const noexcept { return constants_->sizes.joint_count; }
    [[nodiscard]] int outputs() const noexcept { return constants_->sizes.output_count; }

    [[nodiscard]] bool usable(const Observation<Scalar>& observation) const noexcept {
        bool all = true;
        for (int i = 0; i < joints(); ++i) {
            all = all && std::abs(observation.position[i]) <= largest_position; // NaN is not
        }
        for (int k = 0; k < outputs(); ++k) {
            all = all && std::isfinite(observation.output[k]) && std::isfinite(observation.prediction[k]) &&
                  std::isfinite(observation.held_prediction[k]) && observation.standard_deviation[k] > 0 &&
                  std::isfinite(observation.standard_deviation[k]);
        }
        return all;
    }

    [[nodiscard]] static Scalar bounded(Scalar value, Scalar deviation) noexcept {
        return std::clamp(value, -largest_deviation * deviation, largest_deviation * deviation);
    }

    void push(const Observation<Scalar>& observation) noexcept {
        motion_.push(Pose{{observation.position}});
        for (int k = 0; k < outputs(); ++k) {
            deviations_[k] = observation.standard_deviation[k];
            scaled_[k] = bounded((observation.output[k] - observation.prediction[k]) / deviations_[k], 1);
        }
        innovations_.push(scaled_.data());
        for (int k = 0; k < outputs(); ++k) {
            scaled_[k] = bounded(observation.output[k] - observation.held_prediction[k], deviations_[k]);
        }
        residuals_.push(scaled_.data());
    }

    /// Evaluates the columns of payload and force in the middle of the block.
    void take_tool_columns() noexcept {
        tool_columns<Arm, Scalar>(constants_->chain, constants_->sizes, xi_.data(), constants_->tip,
                                  screws_.data(), payload_.data(), force_.data());
        for (int k = 0; k < outputs(); ++k) {
            const Scalar gain = constants_->output_gain[k];
            for (int i = 0; i < payload_columns; ++i) {
                block_[k].payload[i] = gain * payload_[payload_columns * k + i];
            }
            for (int i = 0; i < force_columns; ++i) {
                block_[k].force[i] = gain * force_[force_columns * k + i];
            }
        }
    }

    void accumulate() noexcept {
        const int middle = constants_->lags / 2;
        const Scalar share = 1 / static_cast<Scalar>(constants_->block_samples);
        for (int k = 0; k < outputs(); ++k) {
            OutputBlock<Scalar>& sum = block_[k];
            sum.innovation += share * innovations_.row(middle)[k];
            sum.deviation += share * deviations_[k];
            sum.residual += share * residuals_.row(middle)[k];
            if constexpr (torques) {
                const Scalar velocity = xi_[3 * k + 1];
                using std::abs;
                using std::tanh;
                const Scalar gain = share * constants_->output_gain[k];
                sum.speed += share * abs(velocity);
                sum.friction[0] += gain * tanh(velocity / constants_->sign_velocity);
                sum.friction[1] += gain * velocity;
            }
        }
    }

    /// Stores the current block.
    void end_block(std::int64_t time_ns) noexcept {
        ++newest_;
        std::copy_n(block_.data(), outputs(), past_.data() + slot(newest_) * outputs());
        ends_ns_[slot(newest_)] = time_ns;
        unbroken_ = follows_ ? std::min(unbroken_ + 1, history) : 1;
        follows_ = true;
        ++since_refresh_;
    }

    void drop_block() noexcept {
        samples_ = 0;
        for (int k = 0; k < outputs(); ++k) {
            block_[k] = {};
        }
    }

    [[nodiscard]] const OutputBlock<Scalar>* block_at(std::int64_t number) const noexcept {
        return past_.data() + slot(number) * outputs();
    }

    /// Returns the index of a block in the ring.
    [[nodiscard]] static int slot(std::int64_t number) noexcept { return static_cast<int>(number % history); }

    bool take_in(std::int64_t time_ns) noexcept {
        const OutputBlock<Scalar>* const before = unbroken_ > 1 ? block_at(newest_ - 1) : nullptr;
        const bool alarm = detector_.add(block_.data(), before, constants_->speed);
        const int repeating = repeats();
        told_frozen_ = repeating < 0 ? -1 : told_frozen_;
        if (!changing_ && (alarm || (repeating >= 0 && repeating != told_frozen_))) {
            begin(time_ns, alarm);
        }
        const bool news = changing_ && follow(time_ns, alarm);
        if (!changing_ && !news) {
            bank_.learn(block_.data(), before, constants_->speed);
        }
        drop_block();
        return news;
    }

    /// Returns the channel with the strongest evidence of a frozen reading beyond chance, or -1.
    [[nodiscard]] int repeats() const noexcept {
        int worst = -1;
        for (int c = 0; c < frozen_.channels(); ++c) {
            const bool long_enough = frozen_.run(c) >= 2 * constants_->block_samples;
            const Scalar least = worst < 0 ? repeats_limit_ : frozen_.evidence(worst);
            worst = long_enough && frozen_.evidence(c) > least ? c : worst;
        }
        return worst;
    }

    void begin(std::int64_t time_ns, bool alarm) noexcept {
        changing_ = true;
        told_ = false;
        frozen_evidence_ = 0;
        const int back = std::min(alarm ? detector_.blocks_since_onset() : 3, history - 2);
        onset_ = next_ = std::max(newest_ - back + 1, std::int64_t{2});
        change_.onset_ns = ends_ns_[slot(onset_ - 1)];
        change_.alarm_ns = time_ns;
        change_.end_ns = 0;
        change_.channel = alarm ? detector_.channel() : -1;
        by_detector_ = alarm;
        fitting_ = false;
        alarm_ = newest_;
        const std::int64_t first = newest_ - std::min<std::int64_t>(newest_, history - 1) + 1;
        bank_.start([this, first](int b) { return block_at(first + b); },
                    static_cast<int>(newest_ - first + 1));
    }

    /// Processes one more block of a change. Returns true if there is something new to report.
    bool follow(std::int64_t time_ns, bool alarm) noexcept {
        for (int b = 0; b < catch_up && next_ <= newest_; ++b, ++next_) {
            if (newest_ - next_ + 1 < unbroken_) { // the one before belongs to it
                fit(block_at(next_), block_at(next_ - 1));
            }
        }
        if (const int channel = repeats(); channel >= 0) {
            frozen_evidence_ = frozen_.evidence(channel);
            frozen_channel_ = channel;
        }
        const std::int64_t age = newest_ - onset_;
        const bool over = (!alarm && repeats() < 0) || age >= constants_->longest_blocks;
        const bool time_to_tell = age >= constants_->report_blocks && next_ > newest_;
        if (!time_to_tell) {
            return false;
        }
        const Cause before = change_.cause;
        bank_.judge(frozen_evidence_, frozen_channel_, change_);
        if (over) {
            end(time_ns, alarm);
        }
        const bool news = over || !told_ || before != change_.cause;
        told_ = true;
        return news;
    }

    /// Fits from the block after the first unusual one: sums may have started to rise by chance before the
    /// change, and the change may have started within that block.
    void fit(const OutputBlock<Scalar>* now, const OutputBlock<Scalar>* before) noexcept {
        if (fitting_) {
            bank_.add(now, before, constants_->speed);
        } else if (next_ >= alarm_ || bank_.unusual(now, before, constants_->speed)) {
            fitting_ = true;
            change_.onset_ns = ends_ns_[slot(next_ - 1)];
        }
    }

    void end(std::int64_t time_ns, bool goes_on) noexcept {
        change_.end_ns = time_ns;
        changing_ = false;
        told_frozen_ = change_.cause == Cause::frozen ? change_.where : -1;
        since_refresh_ = 2 * constants_->refresh_blocks;
        if (by_detector_ && change_.cause == Cause::unknown) {
            detector_.nothing_happened();
        }
        if (goes_on) {
            detector_.adopt();
            bank_.relearn();
        }
    }

    const Constants* constants_;
    typename Motion::template Map<Scalar, n> motion_;
    LagWindow<Scalar, m, M> innovations_, residuals_;
    Storage<Screw<Scalar>, m> screws_; ///< workspace
    Inputs xi_;
    Storage<Scalar, product(payload_columns, m)> payload_;
    Storage<Scalar, product(force_columns, m)> force_;
    Outputs scaled_, deviations_;
    Storage<OutputBlock<Scalar>, m> block_;    ///< current block
    Past past_;                                ///< ring of the last blocks
    Storage<std::int64_t, history> ends_ns_{}; ///< their end times
    ChangeDetector<Scalar, m> detector_;
    HypothesisBank<Scalar, m> bank_;
    FrozenWatch<Scalar, sum(n, m)> frozen_;
    Scalar repeats_limit_; ///< evidence above which a channel is frozen
    Change change_;
    int samples_ = 0; ///< in the current block
    std::int64_t newest_ = 0, onset_ = 0, next_ = 0, alarm_ = 0;
    int unbroken_ = 0; ///< consecutive blocks up to the newest, without a gap
    int since_refresh_ = 0;
    int frozen_channel_ = -1, told_frozen_ = -1;
    Scalar frozen_evidence_ = 0;
    bool follows_ = false, changing_ = false, told_ = false, by_detector_ = false, fitting_ = false;
};

} // namespace dfdyn
