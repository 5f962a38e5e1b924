// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/reason.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/model/run_time/runtime_estimator.hpp"
#include "tools/replay/horizon_error.hpp"

#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Counts over all ticks of a replay.
struct ReplayTotals {
    std::size_t ticks = 0;
    std::size_t predicted = 0; ///< with a prediction, also one at the model's bound
    std::size_t learned = 0;
    std::map<std::string_view, std::size_t> reasons; ///< number of occurrences of each `reason_name`
};

/// Results of the embedded estimator for one recording, tick by tick. Vectors have one entry per tick; those
/// of outputs are stored row by row.
struct ReplayedRecording {
    std::string source;
    double clock_origin_s = 0; ///< `time_s` of a sample with stamp 0
    double start_s = 0;        ///< time of the first tick, also if it was removed
    std::vector<double> time_s;
    std::vector<double> measured;                     ///< ticks × m; NaN if not measured
    std::vector<float> predicted;                     ///< ticks × m; NaN without a prediction
    std::vector<float> standard_deviation;            ///< ticks × m; NaN without a prediction
    std::vector<float> normalised_innovation_squared; ///< per tick; NaN without a prediction or measurement
    std::vector<Status> status;
    /// why a bus has no sample, or no output in it; empty without a bus
    std::vector<hal::Reason> bus_reason;
    std::vector<double> duration_us; ///< of each tick, on this machine
    std::vector<HorizonIndex> horizon;
    /// Predictions of the models' rigid bodies with friction: with the robot file's inertia, then with
    /// identified inertia; ticks × m each, NaN where the motion is unknown. Empty: there are none.
    std::vector<std::vector<double>> rigid_body;
    ReplayTotals totals;
    /// If nothing was predicted: the first position beyond the limit of a model, in words; empty: none.
    std::string beyond_limit;
    std::size_t forgotten = 0; ///< removed ticks before the first one of the vectors, see ReplayMemory
};

/// Receives each tick of a replay.
class TickSink {
  public:
    virtual ~TickSink() = default;
    virtual void take(const ReplayedRecording& replayed, std::size_t tick) = 0;
    /// Writes buffered data when there is time for it.
    virtual void flush() = 0;
};

/// Memory limit of a replay. For a replay of unlimited duration, all memory is allocated at the start.
struct ReplayMemory {
    /// minimum number of last ticks to keep; up to twice this number are kept; 0: all
    std::size_t kept_ticks = 0;
    TickSink* sink = nullptr; ///< receives every tick; null: none
};

/// Returns the most relevant reason of a tick ("ok" for none): the bus' reason if there is one, otherwise the
/// estimator's.
std::string_view reason_name(const ReplayedRecording& replayed, std::size_t tick);

/// Returns one row as an input of the estimator; it refers to `recording`.
MeasuredSample sample_at(const Recording& recording, std::size_t row);

/// Returns whether a part of the model needs the recording's own derivatives, columns qd and qdd.
bool needs_derivatives(const TrainedModel& model);

/// Runs an estimator over samples as they arrive, and records its results. Keeps references to both.
class Replayer {
  public:
    /// `horizon`: T of the index ε, 0 for none.
    Replayer(RuntimeEstimator& estimator, std::string source, std::size_t outputs, std::size_t horizon,
             const ReplayMemory& memory = {});

    /// Begins a stretch after a gap: neither the estimator's window nor a horizon of ε extends across it.
    void begin_recording();

    /// Runs one tick. `sample.output` is empty if it was not measured.
    void tick(double time_s, const MeasuredSample& sample);
    /// Runs one tick of a bus; `output`: reason if the output was not measured.
    void tick(double time_s, const MeasuredSample& sample, hal::Reason output);
    /// Registers a tick without positions on the bus.
    void skip(double time_s, hal::Reason position);

    /// Returns everything that was kept; call once, at the end.
    ReplayedRecording finish();

  private:
    void estimate(double time_s, const MeasuredSample& sample);
    void append(const Tick& tick, std::span<const double> output);
    void complete_tick();
    template <class Use>
    void for_each_column(Use use);

    RuntimeEstimator& estimator_;
    std::size_t outputs_, horizon_;
    HorizonError errors_;
    ReplayMemory memory_;
    ReplayedRecording replayed_;
};

/// Runs `estimator` over `recording`, with learning, starting from its present learned state. `on_tick`
/// receives the number of completed ticks. `models`: those of `estimator`. `horizon`: T of the index ε, 0 for
/// none. Throws InputError if the recording lacks the joints, outputs or derivatives of a model.
ReplayedRecording replay(RuntimeEstimator& estimator, std::span<const TrainedModel> models,
                         const Recording& recording, std::size_t horizon,
                         const std::function<void(std::size_t)>& on_tick);

/// rms(measured - predicted) / std(measured) of one output over the ticks in [first, last) with measurement
/// and prediction; NaN if there are none, infinite if all measured values are equal.
double normalised_error(const ReplayedRecording& replayed, std::size_t outputs, std::size_t output,
                        std::size_t first, std::size_t last);

/// Share of ticks with measurement and prediction whose output is within two standard deviations of its
/// prediction; NaN if there are none.
double share_within_two_deviations(const ReplayedRecording& replayed, std::size_t outputs,
                                   std::size_t output);

/// Median of ε of one output over the kept times t in [from_s, to_s) since the recording's start; NaN if
/// there are none. The median is used because ε is relative and becomes arbitrarily large while an output is
/// near zero.
double median_horizon_index(const ReplayedRecording& replayed, std::size_t output, double from_s,
                            double to_s);

} // namespace dfdyn::tools
