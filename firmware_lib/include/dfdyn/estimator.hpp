// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/core/snapshot.hpp"
#include "dfdyn/core/stamp_sequence.hpp"
#include "dfdyn/core/state_sequence.hpp"
#include "dfdyn/core/status.hpp"
#include "dfdyn/estimate.hpp"
#include "dfdyn/innovation_gate.hpp"
#include "dfdyn/model_identity.hpp"
#include "dfdyn/scaled_outputs.hpp"
#include "dfdyn/structure/regression.hpp"

#include <cmath>
#include <limits>

namespace dfdyn {

/// Learns the inverse dynamics of an arm tick by tick and predicts in every tick. The whole state is in this
/// object, without heap or globals; it may be large, so give it static storage. Refers to `constants`, which
/// must outlive it. Not thread-safe: one context ticks it and makes all other calls, or they are made while
/// nothing ticks. Only a `SnapshotWriter` may copy from another context during ticks.
template <class ModelType>
class Estimator {
  public:
    using Model = ModelType;                                  ///< a `dfdyn::Model`
    using Scalar = typename Model::Scalar;                    ///< float or double
    using Constants = typename Model::Constants;              ///< trained model, written by `dfdyn train`
    using Sample = typename Model::Sample;                    ///< positions and outputs of one tick
    using Estimate = dfdyn::Estimate<Scalar, Model::outputs>; ///< result of one tick

    /// The columns and the learner of the model's structure.
    using Regression = typename Model::Structure::template Regression<Model>;
    static_assert(RegressionOf<Regression, Scalar, Sample>);

    explicit Estimator(const Constants&&) = delete; // prevents a reference to a temporary
    /// Starts with an empty window and the learned state that `constants` contain. O(size of the state).
    explicit Estimator(const Constants& constants) noexcept
        : constants_(&constants), sizes_(constants.sizes), learn_cost_(cost(constants.sizes).learn),
          regression_(constants), outputs_(sizes_.output_count),
          gate_(constants.innovation_limit, constants.innovation_patience) {}

    /// Predicts the sample's output from its position and the past positions, then learns the sample within
    /// the budget. A refused sample does not change the learned state.
    ///
    /// Cost, for any input: at most `cost().predict` + `cost().variance` + the budget, in multiply-adds. If
    /// the sample is learned at once, the variance is included in learning. Deciding on gaps takes
    /// `SampleClock::cost` in addition. Within the budget, learning may take more than `cost().learn`:
    ///  - with forgetting, `cost().forget`;
    ///  - for SPK, the products of φ with all weights once more, if another sample was completed in the same
    ///    tick.
    Estimate tick(const Sample& sample, Budget budget) noexcept {
        Estimate estimate = unknown();
        Status& status = estimate.status;
        held_ = !sequence_.try_change();
        status.prediction = accept(sample);
        if (status.predicted() && !regression_.evaluate()) {
            status.prediction = Reason::input_out_of_range;
        }
        if (status.predicted()) {
            predict(sample, budget, estimate);
        } else {
            work(budget);
        }
        end_change();
        count(status);
        return estimate;
    }

    /// Continues to learn earlier samples with at most the budget's multiply-adds, so that learning can be
    /// spread over the time until the next sample. `ticks`: control ticks that a `SnapshotWriter`'s hold
    /// counts. Returns true when nothing is left to do.
    bool advance(Budget budget, std::uint32_t ticks = 0) noexcept {
        held_ = !sequence_.try_change(ticks);
        const bool idle = work(budget);
        end_change();
        return idle;
    }

    /// Returns to the state after construction: the initial state of the constants, an empty window, counters
    /// at zero.
    void reset() noexcept {
        sequence_.begin_change();
        regression_.reset();
        changed_ = 0;
        sequence_.end_change();
        restart_window();
        gate_ = Gate(constants_->innovation_limit, constants_->innovation_patience);
        counters_ = {};
    }

    /// Requests a reset of the covariance to the prior's, after a change of the arm. It begins in the next
    /// tick with a budget. The weights stay and then adapt quickly to new measurements.
    void relearn() noexcept { gate_.report_change(); }

    /// Begins a new recording or motion: restarts the window and the clock, keeps the learned state.
    void restart_window() noexcept {
        regression_.restart();
        stamps_.restart();
        gate_.restart();
    }

    /// Returns the size of a snapshot in bytes. It contains the learned state, including a sample that is
    /// still being learned, but not the window: past positions are useless after a later start.
    [[nodiscard]] std::size_t snapshot_bytes() const noexcept { return dfdyn::snapshot_bytes(*this); }

    /// Size in bytes of a buffer that holds any snapshot of a firmware model.
    static constexpr std::size_t snapshot_capacity =
        sizeof(SnapshotHeader) + sizeof(Regression) + sizeof(int) + sizeof(SnapshotChecksum);

    /// Writes a snapshot to the front of `buffer`, which holds at least `snapshot_bytes()`. This takes as
    /// long as hundreds of ticks. If an interrupt ticks and learns during the copy, the result is `changed`;
    /// use a `SnapshotWriter` in that case.
    [[nodiscard]] SnapshotResult snapshot(std::span<std::byte> buffer) const noexcept {
        const std::uint32_t before = sequence_.read();
        const SnapshotResult result = write_snapshot(*this, model_identity(), buffer);
        const bool whole = before % 2 == 0 && sequence_.read_again() == before;
        return whole || result != SnapshotResult::ok ? result : SnapshotResult::changed;
    }

    /// Restores a snapshot of an estimator of the same model and restarts the window. A rejected snapshot
    /// changes nothing; the result is the reason. O(size of the state).
    [[nodiscard]] SnapshotResult restore(std::span<const std::byte> buffer) noexcept {
        sequence_.begin_change();
        const SnapshotResult result = read_snapshot(*this, model_identity(), buffer);
        sequence_.end_change();
        if (result == SnapshotResult::ok) {
            restart_window();
            gate_ = Gate(constants_->innovation_limit, constants_->innovation_patience);
        }
        return result;
    }

    /// Returns the numbers of ticks, predictions, learned samples and reasons since the last reset.
    [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
    /// Returns the columns and the learned weights, in units of the noise standard deviations.
    [[nodiscard]] const Regression& regression() const noexcept { return regression_; }

    /// Returns the cost of a tick's parts in multiply-adds, a constant expression for a firmware model.
    [[nodiscard]] static constexpr Cost cost(const typename Model::Sizes& sizes = {}) noexcept {
        Cost cost = Regression::cost(sizes);
        cost.predict += std::int64_t{sizes.output_count} * Scaled::conversion_cost +
                        Extrapolation<Scalar>::cost + 1 + Gate::cost;
        cost.variance += std::int64_t{sizes.output_count} * Scaled::square_cost;
        return cost;
    }

    /// Returns the memory of a firmware model in bytes. The stack does not grow with features or lags: it
    /// contains copies of the estimate, and the data of one part at a time.
    [[nodiscard]] static constexpr Footprint footprint() noexcept {
        return {.state_bytes = sizeof(Estimator),
                .constant_bytes = sizeof(Constants) + Model::StructureConstants::start_bytes,
                .stack_bytes = frame_bytes + 3 * sizeof(Estimate) + Regression::stack_bytes({})};
    }

    /// Visits the contents of a snapshot. They change only between `sequence_.begin_change` (or `try_change`)
    /// and `end_change`.
    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        Regression::visit_state(self.regression_, visitor);
        visitor.ranged(self.changed_, 0, 1);
    }

  private:
    template <class>
    friend class SnapshotWriter;

    using Outputs = Storage<Scalar, Model::outputs>;
    using Gate = InnovationGate<Scalar>;
    using Scaled = ScaledOutputs<Model>;

    [[nodiscard]] Estimate unknown() const noexcept {
        Estimate estimate{Outputs::zeros(sizes_.output_count),
                          Outputs::zeros(sizes_.output_count),
                          Outputs::zeros(sizes_.output_count),
                          0,
                          {}};
        for (Scalar& deviation : estimate.standard_deviation) {
            deviation = std::numeric_limits<Scalar>::infinity();
        }
        return estimate;
    }

    /// Checks position and time; an accepted sample enters the window.
    Reason accept(const Sample& sample) noexcept {
        const Reason fault = check_position(sample);
        if (fault != Reason::ok) {
            return fault;
        }
        const Reason order = stamps_.accept(sample.time_ns, constants_->period_ns, constants_->gap_ns);
        if (order == Reason::time_not_increasing) {
            return order;
        }
        if (order != Reason::ok) {
            regression_.restart();
        }
        regression_.push(sample);
        const Reason filling = order == Reason::ok ? Reason::window_filling : order;
        return regression_.ready() ? Reason::ok : filling;
    }

    [[nodiscard]] Reason check_position(const Sample& sample) const noexcept {
        for (int i = 0; i < sizes_.joint_count; ++i) {
            if (!std::isfinite(sample.position[i])) {
                return Reason::position_not_finite;
            }
            if (!(std::abs(sample.position[i]) <= constants_->position_limit[i])) { // also for a NaN limit
                return Reason::position_out_of_range;
            }
        }
        return Reason::ok;
    }

    void predict(const Sample& sample, Budget budget, Estimate& estimate) noexcept {
        regression_.predict(estimate.prediction.data());
        regression_.predict_without_features(outputs_.without_features());
        if (finite(estimate.prediction)) {
            estimate.status.learning = outputs_.check_measured(*constants_, sample);
            learn(sample, budget, estimate);
        }
        if (!finite(estimate.prediction) || !finite(estimate.standard_deviation)) {
            estimate = unknown();
            estimate.status.prediction = Reason::state_not_finite;
        }
    }

    [[nodiscard]] static bool finite(const Outputs& values) noexcept {
        bool all = true;
        for (const Scalar value : values) {
            all = all && std::isfinite(value);
        }
        return all;
    }

    /// Checks the measurement, learns within the budget, oldest sample first, and completes the estimate. A
    /// sample that is learned entirely in this tick provides the variances. Otherwise, or if the variances
    /// decide whether to learn, they are computed separately.
    void learn(const Sample& sample, Budget budget, Estimate& estimate) noexcept {
        Status& status = estimate.status;
        Scalar error_square = status.learning == Reason::ok
                                  ? outputs_.normalise(*constants_, sample, estimate.prediction)
                                  : Scalar(0);
        if (!std::isfinite(error_square)) {
            status.learning = Reason::output_out_of_range;
            error_square = 0;
        }
        const bool measured = status.learning == Reason::ok;
        const bool doubtful =
            measured && !(error_square <= Scalar(Gate::ordinary) * constants_->innovation_limit);
        const bool at_once = measured && !doubtful && !held_ && !gate_.change_pending() &&
                             regression_.idle() && budget.affords(learn_cost_);
        if (!at_once) {
            extrapolate(regression_.variances(outputs_.ratio()), estimate);
        }
        Scalar noise_variance = 0;
        if (measured) {
            noise_variance = weigh(doubtful ? outputs_.innovation_square(estimate.prediction) : Scalar(0),
                                   budget.operations > 0);
            status.learning = noise_variance > 0 ? Reason::ok : Reason::innovation_too_large;
        }
        fold(budget, noise_variance, status);
        if (at_once) {
            extrapolate(regression_.last_variance_ratios(outputs_.ratio()), estimate);
        }
        if (measured) {
            estimate.normalised_innovation_squared = outputs_.innovation_square(estimate.prediction);
        }
        outputs_.to_output_units(*constants_, sample, measured, estimate);
    }

    /// Returns the noise variance of a sample by the gate. A sample that must not be learned, for example
    /// because the caller knows of a contact, is no evidence of a change of the arm.
    [[nodiscard]] Scalar weigh(Scalar innovation_square, bool may_learn) noexcept {
        Gate unaffected = gate_;
        return (may_learn ? gate_ : unaffected).judge(innovation_square);
    }

    /// Applies `Extrapolation` at this input; after a change of the arm, until `reset`, to the variances
    /// only.
    void extrapolate(Scalar feature_variance, Estimate& estimate) noexcept {
        outputs_.extrapolate(*constants_, feature_variance, changed_ == 0, estimate);
    }

    /// Continues an earlier sample, then learns this one unless it was refused.
    void fold(Budget& budget, Scalar noise_variance, Status& status) noexcept {
        bool idle = work(budget);
        if (idle && !held_ && budget.operations > 0 && gate_.take_change()) {
            regression_.reset_covariance();
            changed_ = 1;
            idle = work(budget);
        }
        if (status.learning != Reason::ok) {
            return;
        }
        if (held_) {
            status.learning = Reason::learning_held;
        } else if (!idle) {
            status.learning = Reason::learner_busy;
        } else if (budget.operations <= 0) {
            status.learning = Reason::no_budget;
        } else {
            regression_.begin(outputs_.target().data(), noise_variance);
            work(budget);
            status.learning = regression_.sample_pending() ? Reason::learning_in_progress : Reason::ok;
        }
    }

    /// Continues the learner's present task; returns true when nothing is left to do.
    bool work(Budget& budget) noexcept {
        if (held_) {
            return regression_.idle();
        }
        const bool pending = regression_.sample_pending();
        const bool idle = regression_.advance(budget);
        counters_.learned += pending && !regression_.sample_pending() ? 1 : 0;
        return idle;
    }

    void end_change() noexcept {
        if (!held_) {
            sequence_.end_change();
        }
    }

    void count(const Status& status) noexcept {
        ++counters_.ticks;
        counters_.predicted += status.predicted() ? 1 : 0;
        ++counters_.reasons[static_cast<int>(status.reason())];
    }

    [[nodiscard]] std::uint32_t model_identity() const noexcept {
        return dfdyn::model_identity<Model>(*constants_, sizes_);
    }

    const Constants* constants_;
    [[no_unique_address]] typename Model::Sizes sizes_;
    std::int64_t learn_cost_;
    Regression regression_;
    Scaled outputs_;
    Counters counters_;
    StampSequence stamps_;
    StateSequence sequence_;
    bool held_ = false; ///< no learning in this tick
    Gate gate_;
    int changed_ = 0; ///< 1: a change of the arm was detected since the start
};

} // namespace dfdyn
