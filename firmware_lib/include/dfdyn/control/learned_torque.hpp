// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/snapshot_writer.hpp"
#include "dfdyn/estimator.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

namespace dfdyn {

/// Inverse dynamics that is learned while the arm moves and evaluated at the reference: it learns from
/// windows of measured positions and predicts for a window of reference positions. An `Estimator` alone
/// predicts for the *measured* motion; as feed-forward its prediction would be positive feedback of the
/// position error.
///
/// In addition to the estimator it contains a second window with its columns, and a copy of the learned
/// weights that is updated after each learned sample: 2d m + p scalars and the windows, but no second
/// covariance.
///
/// Samples are one sample period of the model apart. Learning a sample is spread over the control ticks until
/// the next sample. `tick_cost()` bounds every call. Refers to `constants`, which must outlive this object.
/// Never allocates.
template <class ModelType>
class LearnedTorque {
  public:
    using Model = ModelType;                       ///< whose outputs are the torques of all joints
    using Scalar = typename Model::Scalar;         ///< float or double
    using Estimator = dfdyn::Estimator<Model>;     ///< learns from the measured motion
    static constexpr int outputs = Model::outputs; ///< n: one torque per joint
    static constexpr int forecasts = 1;            ///< torques of a joint that `predict` writes
    static_assert(Model::joints == Model::outputs, "outputs must be the torques of all joints");
    static_assert(Model::outputs != dynamic, "sizes must be fixed at compile time");
    static_assert(
        std::is_same_v<typename Model::Sample, dfdyn::Sample<Scalar, Model::joints, Model::outputs>>,
        "the input must be positions: a reference's window has no measured derivatives");

    explicit LearnedTorque(const typename Model::Constants&&, int ticks) = delete;

    /// `ticks`: control ticks per sample period, ≥ 1.
    LearnedTorque(const typename Model::Constants& constants, int ticks) noexcept
        : constants_(&constants), share_(share_of(constants.sizes, ticks > 1 ? ticks : 1)),
          estimator_(constants), columns_(constants), sample_{}, weights_{} {
        take_over();
    }

    /// Returns the number of torques, n.
    [[nodiscard]] Extent<outputs> output_count() const noexcept { return constants_->sizes.output_count; }
    /// Returns the number of forecasts, 1.
    [[nodiscard]] static constexpr Extent<forecasts> forecast_count() noexcept { return {}; }

    /// Starts a motion at `time_ns`: empties the window of the measured motion and fills the window of the
    /// reference with `position` (n values, rad), as if at rest until now. Keeps what was learned.
    void begin(std::int64_t time_ns, const Scalar* position) noexcept {
        estimator_.restart_window();
        columns_.restart();
        int rows = 0;
        for (; rows < longest_window && !columns_.ready(); ++rows) {
            push(time_ns, position);
        }
        columns_.restart();
        for (int row = rows - 1; row >= 0; --row) { // inputs that differentiate need increasing times
            push(time_ns - (row + 1) * constants_->period_ns, position);
        }
    }

    /// Begins to learn a sample: the measured `position` (n values, rad) and the torque that was in effect (n
    /// values, N·m; nullptr if unknown). Returns the status of `Estimator::tick`, which may refuse it.
    Status learn(std::int64_t time_ns, const Scalar* position, const Scalar* torque) noexcept {
        sample_.time_ns = time_ns;
        sample_.output_valid = torque != nullptr;
        for (int k = 0; k < output_count(); ++k) {
            sample_.position[k] = position[k];
            sample_.output[k] = torque != nullptr ? torque[k] : Scalar(0);
        }
        const Status status = estimator_.tick(sample_, share_).status;
        pending_ = true;
        take_over_when_done();
        return status;
    }

    /// Continues to learn the sample. Call it in every control tick without a new sample.
    void go_on() noexcept {
        estimator_.advance(share_, 1); // a control tick: it counts for a hold of a `SnapshotWriter`
        take_over_when_done();
    }

    /// Predicts the torque (n values, N·m) at the reference's `position` (n values, rad), one sample period
    /// after the last call. The torque of a joint is NaN if it is not finite or exceeds the model's limit for
    /// this joint. Returns false and writes zeros if no joint has a torque: while the window fills, if the
    /// input is out of range, or if all exceed their limits. A NaN or infinite position restarts the window.
    /// No variance is computed, so away from the data the prediction does not fade out as in an `Estimate`;
    /// `FeedForward` compares it with the nominal torque instead.
    bool predict(std::int64_t time_ns, const Scalar* position, Scalar* torque) noexcept {
        bool known = true;
        for (int k = 0; k < output_count(); ++k) {
            known = known && std::isfinite(position[k]);
        }
        if (known) {
            push(time_ns, position);
        } else {
            columns_.restart();
        }
        known = known && columns_.ready() && columns_.evaluate();
        if (known) {
            columns_.predict_with(weights_.data(), torque);
        }
        const bool any = known && bound(torque);
        for (int k = 0; !any && k < output_count(); ++k) {
            torque[k] = 0;
        }
        return any;
    }

    /// See `Estimator::relearn`: for an arm that has changed, or is not the arm of the training.
    void relearn() noexcept { estimator_.relearn(); }

    /// Returns to the initial state of the model.
    void reset() noexcept {
        estimator_.reset();
        columns_.restart();
        take_over();
    }

    /// Returns the estimator of the measured motion, for its counters and costs. Never feed its prediction
    /// forward.
    [[nodiscard]] const Estimator& estimator() const noexcept { return estimator_; }
    /// Size in bytes of a buffer that holds any snapshot.
    static constexpr std::size_t snapshot_capacity = Estimator::snapshot_capacity;
    /// See `Estimator::snapshot`.
    [[nodiscard]] SnapshotResult snapshot(std::span<std::byte> buffer) const noexcept {
        return estimator_.snapshot(buffer);
    }
    /// Returns a writer that takes a snapshot in pieces while an interrupt ticks: see `SnapshotWriter`. Its
    /// ticks are control ticks: calls of `learn` and `go_on`.
    [[nodiscard]] SnapshotWriter<Estimator>
    snapshot_writer(std::uint32_t max_held_ticks = SnapshotWriter<Estimator>::default_held_ticks) noexcept {
        return SnapshotWriter<Estimator>(estimator_, max_held_ticks);
    }
    /// See `Estimator::restore`. Restarts both windows; call `begin` next.
    [[nodiscard]] SnapshotResult restore(std::span<const std::byte> buffer) noexcept {
        const SnapshotResult result = estimator_.restore(buffer);
        if (result == SnapshotResult::ok) {
            columns_.restart();
            pending_ = true;
            take_over_when_done();
        }
        return result;
    }

    /// Returns the maximum multiply-adds of a control tick: `learn` or `go_on`, plus `predict`.
    [[nodiscard]] std::int64_t tick_cost() const noexcept {
        const Cost cost = Estimator::cost(constants_->sizes);
        return 2 * cost.predict + cost.variance + share_.operations;
    }

  private:
    using Columns = typename Model::Structure::template Columns<Model>;
    static_assert(ColumnsOf<Columns, Scalar, typename Model::Sample>);

    /// Maximum window length of any model, in samples; bounds a loop.
    static constexpr int longest_window = 4096;

    /// Returns the budget per tick that suffices to learn a sample in `ticks` slices. Each slice may leave a
    /// remainder that is too small for the next step.
    static constexpr Budget share_of(const typename Model::Sizes& sizes, int ticks) noexcept {
        const Cost cost = Estimator::cost(sizes);
        return {(cost.learn + cost.forget + ticks - 1) / ticks + cost.largest_step};
    }

    void push(std::int64_t time_ns, const Scalar* position) noexcept {
        sample_.time_ns = time_ns;
        for (int k = 0; k < output_count(); ++k) {
            sample_.position[k] = position[k];
        }
        columns_.push(sample_);
    }

    /// Converts predictions in units of the noise to torques; NaN for one beyond its limit, so that the other
    /// joints keep theirs. Returns whether any joint has a torque.
    bool bound(Scalar* torque) const noexcept {
        bool any = false;
        for (int k = 0; k < output_count(); ++k) {
            const Scalar value = constants_->output_offset[k] + constants_->output_noise_std[k] * torque[k];
            const Scalar limit = constants_->prediction_limit[k];
            const bool good = std::isfinite(value) && !(limit > 0 && std::abs(value) > limit);
            torque[k] = good ? value : std::numeric_limits<Scalar>::quiet_NaN();
            any = any || good;
        }
        return any;
    }

    void take_over_when_done() noexcept {
        if (pending_ && estimator_.regression().idle()) {
            take_over();
        }
    }

    void take_over() noexcept {
        estimator_.regression().copy_weights(weights_.data());
        pending_ = false;
    }

    const typename Model::Constants* constants_;
    Budget share_; ///< per control tick
    Estimator estimator_;
    Columns columns_; ///< columns at the reference
    typename Model::Sample sample_;
    Storage<Scalar, Columns::weights> weights_;
    bool pending_ = false; ///< the estimator may have newer weights than `weights_`
};

} // namespace dfdyn
