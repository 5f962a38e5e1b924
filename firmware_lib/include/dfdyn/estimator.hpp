// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/core/sample_clock.hpp"
#include "dfdyn/core/snapshot.hpp"
#include "dfdyn/core/state_sequence.hpp"
#include "dfdyn/core/status.hpp"
#include "dfdyn/innovation_gate.hpp"
#include "dfdyn/input/input_identity.hpp"
#include "dfdyn/model.hpp"
#include "dfdyn/structure/regression.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn {

/// Result of one tick. Without a prediction the value is 0, so that feeding it forward unchecked adds no
/// torque, and its standard deviation is infinite. A prediction beyond the model's `prediction_limit` is
/// replaced by that limit, and its standard deviation is at least the distance between the two.
template <class Scalar, int m>
struct Estimate {
    Storage<Scalar, m> prediction;         ///< in the output's unit, computed before the sample is learned
    Storage<Scalar, m> standard_deviation; ///< of the measurement about the prediction: parameters and noise
    Storage<Scalar, m> innovation;         ///< measured - prediction; 0 without a usable measurement
    /// Sum over the outputs of (measured - prediction)² / `standard_deviation`², both before the bound. About
    /// m while the model is valid, 0 without a measurement. If outputs share parameters (P, SPK) it is not
    /// chi-square, because the correlation of their errors is ignored.
    Scalar normalised_innovation_squared;
    Status status; ///< whether there is a prediction, whether the sample was learned, and why not
};

/// Number of occurrences of each reason since the last reset; monotonic in between. 64 bits suffice for 584
/// million years at 1 kHz. 32 bits would wrap after 49.7 days, and a saturated counter would hide every later
/// fault. A 32-bit core reads a counter in two loads, so read it in the context that ticks, or while nothing
/// ticks.
struct Counters {
    std::uint64_t ticks = 0;     ///< calls of `tick`
    std::uint64_t predicted = 0; ///< ticks with a prediction of the model itself, within its bound
    std::uint64_t learned = 0;   ///< samples learned completely
    /// Indexed by the reason's number: the reason of the prediction, or of learning if predicted.
    Storage<std::uint64_t, reason_count> reasons{};
};

/// Learns the inverse dynamics of an arm tick by tick and predicts in every tick. The whole state is in this
/// object, without heap or globals; it may be large, so give it static storage. Refers to `constants`, which
/// must outlive it. Not thread-safe: one context ticks it and makes all other calls, or they are made while
/// nothing ticks. Only a `SnapshotWriter` may copy from another context during ticks.
template <class ModelType>
class Estimator {
  public:
    using Model = ModelType;                                  ///< a `dfdyn::Model`
    using Scalar = typename Model::Scalar;                    ///< float or double
    using Constants = typename Model::Constants;              ///< what `dfdyn train` writes
    using Sample = typename Model::Sample;                    ///< positions and outputs of one tick
    using Estimate = dfdyn::Estimate<Scalar, Model::outputs>; ///< result of one tick

    /// The columns and the learner of the model's structure.
    using Regression = typename Model::Structure::template Regression<Model>;
    static_assert(RegressionOf<Regression, Scalar, Sample>);

    /// Consecutive samples with earlier time stamps after which the sender's clock is assumed to have been
    /// set back.
    static constexpr int clock_restart_samples = 3;

    explicit Estimator(const Constants&&) = delete; // prevents a reference to a temporary
    /// Starts with an empty window and the learned state that `constants` contain. O(size of the state).
    explicit Estimator(const Constants& constants) noexcept
        : constants_(&constants), sizes_(constants.sizes), learn_cost_(cost(constants.sizes).learn),
          regression_(constants), target_(Outputs::zeros(sizes_.output_count)), ratio_(target_),
          without_features_(target_), gate_(constants.innovation_limit, constants.innovation_patience) {}

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
    /// spread over the time until the next sample. Returns true when nothing is left to do.
    bool advance(Budget budget) noexcept {
        held_ = !sequence_.try_change(0);
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

    /// The arm is known to have changed: the next tick with a budget begins to take the covariance back to
    /// the prior's, so that the weights, which stay, soon follow what is measured from now on.
    void relearn() noexcept { gate_.report_change(); }

    /// Begins a new recording or motion: the window and the clock start again, what has been learned stays.
    void restart_window() noexcept {
        regression_.restart();
        clock_.restart();
        has_time_ = false;
        past_samples_ = 0;
        gate_.restart();
    }

    /// Returns the size of a snapshot in bytes. It contains the learned state, including a sample that is
    /// still being learned, but not the window: past positions are of no use after a later start.
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
    /// changes nothing.
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
        cost.predict +=
            std::int64_t{sizes.output_count} * output_cost + Extrapolation<Scalar>::cost + 1 + Gate::cost;
        cost.variance += std::int64_t{sizes.output_count} * square_cost;
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

    /// Multiply-adds per output for the conversion between the regression's units and the output's.
    static constexpr int output_cost = function_cost + 15;
    /// Multiply-adds per output in `innovation_square`.
    static constexpr int square_cost = 2;

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
        Reason filling = Reason::window_filling;
        if (has_time_ && sample.time_ns <= last_time_ns_) {
            if (!clock_restarted(sample.time_ns)) {
                return Reason::time_not_increasing;
            }
            regression_.restart();
            clock_.restart();
            filling = Reason::clock_restarted;
        } else if (has_time_ && lost_before(time_since_last(sample))) {
            regression_.restart();
            filling = Reason::gap;
        }
        past_samples_ = 0;
        has_time_ = true;
        last_time_ns_ = sample.time_ns;
        regression_.push(sample);
        return regression_.ready() ? Reason::ok : filling;
    }

    /// Returns true if samples were lost in a step of that length (ns).
    bool lost_before(std::uint64_t step_ns) noexcept {
        return constants_->period_ns > 0 ? clock_.lost_before(step_ns, constants_->period_ns)
                                         : step_ns > static_cast<std::uint64_t>(constants_->gap_ns);
    }

    /// Returns the time since the last sample (ns), for a sample that is later; the difference of two stamps
    /// may need all 64 bits.
    [[nodiscard]] std::uint64_t time_since_last(const Sample& sample) const noexcept {
        return static_cast<std::uint64_t>(sample.time_ns) - static_cast<std::uint64_t>(last_time_ns_);
    }

    [[nodiscard]] Reason check_position(const Sample& sample) const noexcept {
        for (int i = 0; i < sizes_.joint_count; ++i) {
            if (!std::isfinite(sample.position[i])) {
                return Reason::position_not_finite;
            }
            if (std::abs(sample.position[i]) > constants_->position_limit[i]) {
                return Reason::position_out_of_range;
            }
        }
        return Reason::ok;
    }

    [[nodiscard]] Reason check_output(const Sample& sample) const noexcept {
        if (!sample.output_valid) {
            return Reason::output_missing;
        }
        for (int k = 0; k < sizes_.output_count; ++k) {
            if (!std::isfinite(sample.output[k])) {
                return Reason::output_not_finite;
            }
            if (std::abs(sample.output[k]) > constants_->output_limit[k]) {
                return Reason::output_out_of_range;
            }
        }
        return Reason::ok;
    }

    /// Processes a stamp that is not later than the last one. A single such sample is an outlier; several in
    /// a row with earlier stamps indicate a new clock.
    bool clock_restarted(std::int64_t time_ns) noexcept {
        past_samples_ = time_ns < last_time_ns_ ? past_samples_ + 1 : 0;
        return past_samples_ == clock_restart_samples;
    }

    void predict(const Sample& sample, Budget budget, Estimate& estimate) noexcept {
        regression_.predict(estimate.prediction.data());
        regression_.predict_without_features(without_features_.data());
        if (finite(estimate.prediction)) {
            estimate.status.learning = check_output(sample);
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
        Scalar error_square =
            status.learning == Reason::ok ? normalise(sample, estimate.prediction) : Scalar(0);
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
            extrapolate(regression_.variances(ratio_.data()), estimate);
        }
        Scalar noise_variance = 0;
        if (measured) {
            noise_variance = gate_.judge(doubtful ? innovation_square(estimate.prediction) : Scalar(0));
            status.learning = noise_variance > 0 ? Reason::ok : Reason::innovation_too_large;
        }
        fold(budget, noise_variance, status);
        if (at_once) {
            extrapolate(regression_.last_variance_ratios(ratio_.data()), estimate);
        }
        if (measured) {
            estimate.normalised_innovation_squared = innovation_square(estimate.prediction);
        }
        complete(sample, measured, estimate);
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
            regression_.begin(target_.data(), noise_variance);
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

    /// Converts the measured outputs to the regression's units (relative to offset and noise). Returns the
    /// sum of the squared differences from the prediction.
    Scalar normalise(const Sample& sample, const Outputs& prediction) noexcept {
        Scalar error_square = 0;
        for (int k = 0; k < sizes_.output_count; ++k) {
            target_[k] = (sample.output[k] - constants_->output_offset[k]) / constants_->output_noise_std[k];
            const Scalar error = target_[k] - prediction[k];
            error_square += error * error;
        }
        return error_square;
    }

    /// Reduces the prediction, in units of the noise, by the doubt at its input (see `Extrapolation`), and
    /// converts `ratio_` to the variances of measurements about it. After a change of the arm, P covers only
    /// the samples since then, while the weights are still the best estimate elsewhere; the prediction is
    /// then not reduced until `reset`.
    void extrapolate(Scalar feature_variance, Estimate& estimate) noexcept {
        const auto& known = constants_->extrapolation;
        const Extrapolation<Scalar> beyond(feature_variance, known.inverse_far_variance,
                                           known.parameter_variance_factor);
        const bool given = known.measured();
        const Scalar doubt = changed_ == 0 ? beyond.doubt() : Scalar(0);
        for (int k = 0; k < sizes_.output_count; ++k) {
            const Scalar output_variance = given ? known.output_variance[k] : Scalar(0);
            const Scalar open = beyond.parameter_doubt(ratio_[k], feature_variance, output_variance);
            const Scalar trust = 1 - (changed_ == 0 ? open : Scalar(0));
            estimate.prediction[k] -= doubt * (estimate.prediction[k] - without_features_[k]);
            estimate.prediction[k] *= trust;
            ratio_[k] = beyond.variance(ratio_[k], feature_variance, given ? known.extra_noise[k] : Scalar(0),
                                        given ? known.prior_variance[k] : Scalar(0), output_variance);
        }
    }

    /// Returns the normalised squared innovation of the targets about a prediction in units of the noise,
    /// after `extrapolate`. Ignores the correlation of errors between outputs that share parameters.
    [[nodiscard]] Scalar innovation_square(const Outputs& prediction) const noexcept {
        Scalar total = 0;
        for (int k = 0; k < sizes_.output_count; ++k) {
            const Scalar innovation = target_[k] - prediction[k];
            total += innovation * innovation / ratio_[k];
        }
        return std::min(total, std::numeric_limits<Scalar>::max());
    }

    /// Converts the estimate from the regression's units to the output's and applies the prediction limits.
    void complete(const Sample& sample, bool measured, Estimate& estimate) const noexcept {
        for (int k = 0; k < sizes_.output_count; ++k) {
            const Scalar noise = constants_->output_noise_std[k];
            estimate.prediction[k] = constants_->output_offset[k] + noise * estimate.prediction[k];
            using std::sqrt;
            estimate.standard_deviation[k] = noise * sqrt(ratio_[k]);
            if (k < constants_->prediction_limit.size()) { // may be absent with run-time sizes
                bound(constants_->prediction_limit[k], k, estimate);
            }
            estimate.innovation[k] = measured ? sample.output[k] - estimate.prediction[k] : Scalar(0);
        }
    }

    /// Limits the prediction of output k to ±`limit` if `limit` > 0.
    static void bound(Scalar limit, int k, Estimate& estimate) noexcept {
        const Scalar own = estimate.prediction[k];
        if (!(limit > 0) || (own <= limit && own >= -limit)) {
            return;
        }
        const Scalar bounded = own > 0 ? limit : -limit;
        estimate.prediction[k] = bounded;
        const Scalar moved = own > 0 ? own - limit : -limit - own;
        Scalar& deviation = estimate.standard_deviation[k];
        deviation = std::max(deviation, moved);
        estimate.status.prediction = Reason::prediction_bounded;
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

    /// Returns a checksum over the kinds of all parts, the sizes, the scalar and the constants' identity,
    /// because models that differ in any of these may have the same identity.
    [[nodiscard]] std::uint32_t model_identity() const noexcept {
        const std::int32_t parts[] = {sizes_.joint_count,
                                      sizes_.output_count,
                                      sizes_.lag_count,
                                      sizes_.features_per_joint,
                                      sizes_.feature_count,
                                      sizes_.physics.column_count,
                                      sizeof(Scalar),
                                      Model::Structure::identity,
                                      Regression::Learner::identity,
                                      Model::Features::identity,
                                      input_identity<typename Model::Input>(constants_->input)};
        const std::uint32_t kinds = crc32(std::as_bytes(std::span(parts)), constants_->identity);
        return crc32_of(Model::Physics::identity_of(constants_->physics), kinds);
    }

    const Constants* constants_;
    [[no_unique_address]] typename Model::Sizes sizes_;
    std::int64_t learn_cost_;
    Regression regression_;
    SampleClock clock_;
    Outputs target_;
    Outputs ratio_; ///< variance of a measurement about each prediction, in units of the noise variance
    Outputs without_features_; ///< prediction of the physics alone, in the regression's units
    Counters counters_;
    StateSequence sequence_;
    bool held_ = false; ///< no learning in this tick
    std::int64_t last_time_ns_ = 0;
    bool has_time_ = false;
    int past_samples_ = 0;
    Gate gate_;
    int changed_ = 0; ///< 1: a change of the arm was detected since the start
};

} // namespace dfdyn
