// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/change_detector.hpp"
#include "dfdyn/monitor/frozen_watch.hpp"
#include "dfdyn/monitor/hypothesis_bank.hpp"
#include "dfdyn/monitor/observed_blocks.hpp"

namespace dfdyn {

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
///         has_update = monitor.tick(observation);
///     } else {
///         monitor.interrupt();
///     }
///
/// Cost per tick: at most `cost()`, at the end of a block during a change; otherwise a fraction of it. No
/// heap. Memory: about 13 m `history` + 260 m scalars, see `sizeof`.
template <class Scalar, class Arm, int M, int history = 48>
class Monitor {
  public:
    static constexpr int n = Arm::joints;               ///< joints
    static constexpr int m = Arm::outputs;              ///< outputs
    using Change = dfdyn::Change<Scalar, m>;            ///< a change with its most probable cause
    using Constants = MonitorConstants<Scalar, Arm, M>; ///< geometry, time scales, false-alarm rate

    static constexpr int catch_up = 3; ///< stored blocks that the bank adds per new block
    /// Smallest usual scale of a block's innovation, relative to the scale of white innovations with the
    /// predicted deviation. A deviation that the estimator overestimates, as after a standstill, is then not
    /// taken as evidence.
    static constexpr Scalar least_scale = Scalar(0.25);

    explicit Monitor(const Constants&&) = delete; // it would refer to a temporary
    /// Starts without a change. Refers to `constants`.
    explicit Monitor(const Constants& constants) noexcept
        : constants_(&constants), blocks_(constants),
          detector_(constants.sizes.output_count, Blocks::torques, constants.blocks_between_false_alarms,
                    least_scale / std::sqrt(static_cast<Scalar>(constants.block_samples))),
          bank_(constants.sizes.output_count, Blocks::torques),
          frozen_(extent<sum(n, m)>(joints() + outputs()), joints()),
          repeats_limit_(2 * std::log(constants.blocks_between_false_alarms *
                                      static_cast<Scalar>(joints() + outputs()))) {
        change_.bias = Outputs::zeros(constants.sizes.output_count);
        since_refresh_ = 2 * constants.refresh_blocks;
    }

    /// Processes one tick. Values that are not finite and absurd positions count as a gap. Returns true if
    /// `change()` is new, has another cause, or is over. Cost: `cost`.
    bool tick(const Observation<Scalar>& observation) noexcept {
        if (!blocks_.usable(observation)) {
            interrupt();
            return false;
        }
        frozen_.add(observation.position, observation.output);
        if (!blocks_.add(observation)) {
            return false;
        }
        ++since_refresh_;
        return process_block(observation.time_ns);
    }

    /// Reports a gap: nothing was measured, or samples are missing. Windows and the current block restart.
    void interrupt() noexcept {
        blocks_.interrupt();
        frozen_.restart();
    }

    /// Starts another recording or motion: a gap that also ends a present change without a further report.
    void restart() noexcept {
        interrupt();
        detector_.restart();
        changing_ = false;
        since_refresh_ = 2 * constants_->refresh_blocks;
    }

    /// Returns true if the delayed weights are due for a refresh; call `refreshed` after it. At the start and
    /// after a change both copies are due, so that no older weights remain.
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
        const int outputs = sizes.output_count;
        const std::int64_t tick =
            Blocks::cost(sizes, lags) + FrozenWatch<Scalar, 1>::cost * (sizes.joint_count + outputs);
        using Bank = HypothesisBank<Scalar, m>;
        return tick + ChangeDetector<Scalar, m>::cost(outputs) + catch_up * Bank::cost_of_add(outputs) +
               std::max(Bank::cost_of_start(outputs, history), Bank::cost_of_judge(outputs));
    }

  private:
    using Blocks = ObservedBlocks<Scalar, Arm, M, history>;
    using Outputs = Storage<Scalar, m>;

    [[nodiscard]] int joints() const noexcept { return constants_->sizes.joint_count; }
    [[nodiscard]] int outputs() const noexcept { return constants_->sizes.output_count; }

    bool process_block(std::int64_t time_ns) noexcept {
        const OutputBlock<Scalar>* const now = blocks_.block(blocks_.newest());
        const OutputBlock<Scalar>* const before =
            blocks_.unbroken() > 1 ? blocks_.block(blocks_.newest() - 1) : nullptr;
        const bool alarm = detector_.add(now, before, constants_->speed);
        const int repeating = repeats();
        reported_frozen_ = repeating < 0 ? -1 : reported_frozen_;
        if (!changing_ && (alarm || (repeating >= 0 && repeating != reported_frozen_))) {
            begin(time_ns, alarm);
        }
        const bool has_update = changing_ && follow(time_ns, alarm);
        if (!changing_ && !has_update) {
            bank_.learn(now, before, constants_->speed);
        }
        return has_update;
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
        reported_ = false;
        frozen_evidence_ = 0;
        const int back = std::min(alarm ? detector_.blocks_since_onset() : 3, history - 2);
        onset_ = next_ = std::max(blocks_.newest() - back + 1, std::int64_t{2});
        change_.onset_ns = blocks_.end_ns(onset_ - 1);
        change_.alarm_ns = time_ns;
        change_.end_ns = 0;
        change_.channel = alarm ? detector_.channel() : -1;
        by_detector_ = alarm;
        fitting_ = false;
        alarm_ = blocks_.newest();
        const std::int64_t first =
            blocks_.newest() - std::min<std::int64_t>(blocks_.newest(), history - 1) + 1;
        bank_.start([this, first](int b) { return blocks_.block(first + b); },
                    static_cast<int>(blocks_.newest() - first + 1));
    }

    /// Processes one more block of a change. Returns true if there is something new to report.
    bool follow(std::int64_t time_ns, bool alarm) noexcept {
        for (int b = 0; b < catch_up && next_ <= blocks_.newest(); ++b, ++next_) {
            if (blocks_.newest() - next_ + 1 < blocks_.unbroken()) { // the one before belongs to it
                fit(blocks_.block(next_), blocks_.block(next_ - 1));
            }
        }
        if (const int channel = repeats(); channel >= 0) {
            frozen_evidence_ = frozen_.evidence(channel);
            frozen_channel_ = channel;
        }
        const std::int64_t age = blocks_.newest() - onset_;
        const bool over = (!alarm && repeats() < 0) || age >= constants_->longest_blocks;
        const bool report_due = age >= constants_->report_blocks && next_ > blocks_.newest();
        if (!report_due) {
            return false;
        }
        const Cause before = change_.cause;
        bank_.judge(frozen_evidence_, frozen_channel_, change_);
        if (over) {
            end(time_ns, alarm);
        }
        const bool has_update = over || !reported_ || before != change_.cause;
        reported_ = true;
        return has_update;
    }

    /// Fits from the block after the first unusual one: sums may have started to rise by chance before the
    /// change, and the change may have started within that block.
    void fit(const OutputBlock<Scalar>* now, const OutputBlock<Scalar>* before) noexcept {
        if (fitting_) {
            bank_.add(now, before, constants_->speed);
        } else if (next_ >= alarm_ || bank_.unusual(now, before, constants_->speed)) {
            fitting_ = true;
            change_.onset_ns = blocks_.end_ns(next_ - 1);
        }
    }

    void end(std::int64_t time_ns, bool alarm) noexcept {
        change_.end_ns = time_ns;
        changing_ = false;
        reported_frozen_ = change_.cause == Cause::frozen ? change_.where : -1;
        since_refresh_ = 2 * constants_->refresh_blocks;
        if (by_detector_ && change_.cause == Cause::unknown) {
            detector_.report_false_alarm();
        }
        if (alarm) {
            detector_.adopt();
            bank_.relearn();
        }
    }

    const Constants* constants_;
    Blocks blocks_;
    ChangeDetector<Scalar, m> detector_;
    HypothesisBank<Scalar, m> bank_;
    FrozenWatch<Scalar, sum(n, m)> frozen_;
    Scalar repeats_limit_; ///< evidence above which a channel is frozen
    Change change_;
    std::int64_t onset_ = 0, next_ = 0, alarm_ = 0;
    int since_refresh_ = 0;
    int frozen_channel_ = -1, reported_frozen_ = -1;
    Scalar frozen_evidence_ = 0;
    bool changing_ = false, reported_ = false, by_detector_ = false, fitting_ = false;
};

} // namespace dfdyn
