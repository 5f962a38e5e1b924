// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/core/status.hpp"
#include "tools/model/model.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// Result of one tick of the embedded estimator.
struct Tick {
    std::span<const float> prediction;         ///< of each output; 0 if the status reports no prediction
    std::span<const float> standard_deviation; ///< of each output
    float normalised_innovation_squared = 0;
    Status status;
    std::chrono::nanoseconds duration{}; ///< of `Estimator::tick` only
};

/// Input of one tick: one row of a recording.
struct MeasuredSample {
    std::int64_t time_ns = 0;
    std::span<const double> position;     ///< n values
    std::span<const double> velocity;     ///< n values; used by models of measured derivatives only
    std::span<const double> acceleration; ///< n values; used by models of measured derivatives only
    std::span<const double> output;       ///< m values; empty: not measured, predict only
};

/// The embedded estimator of any model, for any sizes and input: the firmware's code behind one interface.
class RuntimeEstimator {
  public:
    virtual ~RuntimeEstimator() = default;

    /// Runs one tick, as `Estimator::tick`. The spans in the result are valid until the next tick.
    virtual Tick tick(const MeasuredSample& sample, Budget budget) = 0;
    /// Runs one tick with an unlimited budget.
    Tick tick(const MeasuredSample& sample) { return tick(sample, Budget::unlimited()); }

    /// Continues the learning that earlier ticks began. Returns true if no work is left (see
    /// Estimator::advance).
    virtual bool advance(Budget budget) = 0;

    /// Computes the prediction of the last tick's columns with other weights (from `copy_weights`): m values
    /// into `prediction`, within the model's bounds. Returns false if one of them exceeded its bound. Unlike
    /// a tick's prediction it does not fade away from the data, because the variance of the weights is
    /// unknown.
    virtual bool predict_with(std::span<const float> weights, std::span<float> prediction) const = 0;

    /// Number of learned values: the weights of all outputs, m × 2d, and the physics' parameters if they are
    /// learned.
    virtual std::size_t weight_count() const = 0;
    /// Copies them. Requires that no learning work is left.
    virtual void copy_weights(std::span<float> weights) const = 0;

    /// Reacts to a known change of the arm (see Estimator::relearn). Estimators that do not learn ignore it.
    virtual void relearn() {}

    /// Begins a recording: the window restarts, and the learned state remains.
    virtual void begin_recording() = 0;

    /// Returns the learned state in the firmware's format.
    virtual std::vector<std::byte> snapshot() const = 0;

    /// Restores a `snapshot` of an estimator of the same model, with an empty window. Returns false, without
    /// any change, for any other data.
    virtual bool restore(std::span<const std::byte> snapshot) = 0;

    /// Size of a snapshot in the firmware's types, bytes.
    virtual std::size_t state_bytes() const = 0;
    virtual Cost cost() const = 0;
};

/// Returns the estimator of `model`, with the trained initial state or with the prior. Keeps no reference to
/// `model`.
std::unique_ptr<RuntimeEstimator> make_estimator(const TrainedModel& model, bool from_prior);

/// Returns the estimator of the models' combination (combined_estimator.hpp), or of a single model.
/// `models`: at least one, all for the same joints and outputs.
std::unique_ptr<RuntimeEstimator> make_estimator(std::span<const TrainedModel> models, bool from_prior);

} // namespace dfdyn::tools
