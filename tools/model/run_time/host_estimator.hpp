// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/budget.hpp"
#include "dfdyn/status.hpp"
#include "tools/model/model.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// What one tick of the embedded estimator gave.
struct Tick {
    std::span<const float> prediction; ///< of each output; 0 where the status says that nothing was predicted
    std::span<const float> standard_deviation; ///< of each output
    float normalised_innovation_squared = 0;
    Status status;
    std::chrono::nanoseconds duration{}; ///< of `Estimator::tick` alone
};

/// What one row of a recording has for a tick.
struct MeasuredSample {
    std::int64_t time_ns = 0;
    std::span<const double> position;     ///< n values
    std::span<const double> velocity;     ///< n values; read by models of measured derivatives only
    std::span<const double> acceleration; ///< likewise
    std::span<const double> output;       ///< m values; empty: nothing was measured, predict only
};

/// The embedded estimator of any model, whatever its sizes and input: what the firmware runs, behind one
/// interface.
class HostEstimator {
  public:
    virtual ~HostEstimator() = default;

    /// One tick, as `Estimator::tick`. The spans in the result live until the next tick.
    virtual Tick tick(const MeasuredSample& sample, Budget budget) = 0;
    /// With an unlimited budget.
    Tick tick(const MeasuredSample& sample) { return tick(sample, Budget::unlimited()); }

    /// Goes on with what earlier ticks began to learn; true when nothing is left (see Estimator::advance).
    virtual bool advance(Budget budget) = 0;

    /// What the columns of the last tick predict with other weights (as `weights` gave them); m values into
    /// `prediction`, within the model's bounds. False if one of them was beyond. Not faded away from the
    /// data, unlike a tick's: the weights' own variance is not known.
    virtual bool predict_with(std::span<const float> weights, std::span<float> prediction) const = 0;

    /// What has been learned as plain numbers: the weights of all outputs, m × 2d, and the physics'
    /// parameters where they are learned too.
    virtual std::size_t weight_count() const = 0;
    /// While nothing is left to learn.
    virtual void copy_weights(std::span<float> weights) const = 0;

    /// The arm is known to have changed (see Estimator::relearn); an estimator that does not learn on its own
    /// ignores it.
    virtual void relearn() {}

    /// Begins a recording: the window restarts, what has been learned stays.
    virtual void begin_recording() = 0;

    /// What has been learned, in the firmware's own format.
    virtual std::vector<std::byte> snapshot() const = 0;

    /// Back to what had been learned at the `snapshot` of an estimator of the same model, with an empty
    /// window; false, and nothing changed, when it is no such snapshot.
    virtual bool restore(std::span<const std::byte> snapshot) = 0;

    /// Bytes of what has been learned (a snapshot of it), in the firmware's types.
    virtual std::size_t state_bytes() const = 0;
    virtual Cost cost() const = 0;
};

/// The estimator of `model`, from its trained start or from the prior. Keeps no reference to `model`.
std::unique_ptr<HostEstimator> make_estimator(const TrainedModel& model, bool from_prior);

/// The estimator of the models' combination (combined_estimator.hpp); of a single one, its own. `models`: at
/// least one, of the same joints and outputs.
std::unique_ptr<HostEstimator> make_estimator(std::span<const TrainedModel> models, bool from_prior);

} // namespace dfdyn::tools
