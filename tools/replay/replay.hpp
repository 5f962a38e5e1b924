// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/reason.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/model/run_time/host_estimator.hpp"
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
    std::size_t ticks = 0, predicted = 0, learned = 0;
    std::map<std::string_view, std::size_t> reasons; ///< how often each `reason_name` occurred
};

/// What the embedded estimator did with one recording, tick by tick. Vectors over ticks; those of outputs row
/// by row.
struct ReplayedRecording {
    std::string source;
    double clock_origin_s = 0; ///< `time_s` of a sample stamped 0
    std::vector<double> time_s;
    std::vector<double> measured;                     ///< ticks × m; NaN where nothing was measured
    std::vector<float> predicted;                     ///< ticks × m; NaN where nothing was predicted
    std::vector<float> standard_deviation;            ///< ticks × m; likewise
    std::vector<float> normalised_innovation_squared; ///< per tick; NaN where there is none
    std::vector<Status> status;
    std::vector<hal::Reason> bus_reason; ///< why a bus has no sample, or no output in it; else empty
    std::vector<double> duration_us;     ///< of each tick, on this machine
    std::vector<HorizonIndex> horizon;
    /// Of the models' rigid bodies with friction: the robot file's inertia, then identified inertia; ticks ×
    /// m each, NaN where the motion is not known. Empty: there are none.
    std::vector<std::vector<double>> rigid_body;
    ReplayTotals totals;
    std::size_t forgotten = 0; ///< ticks before the first one of the vectors, see ReplayMemory
};

/// Gets each tick of a replay as it is done.
class TickSink {
  public:
    virtual ~TickSink() = default;
    virtual void take(const ReplayedRecording& replayed, std::size_t tick) = 0;
    /// There is time to write out what it holds back.
    virtual void flush() = 0;
};

/// How much of a replay is kept. A replay without end needs a bound: its memory is then taken once, at the
/// start.
struct ReplayMemory {
    std::size_t kept_ticks = 0; ///< at least that many of the last ticks, at most twice as many; 0: all
    TickSink* sink = nullptr;   ///< of every tick; null: none
};

/// The one reason worth reporting of a tick ("ok" for none): the bus' if there is one, else the estimator's.
std::string_view reason_name(const ReplayedRecording& replayed, std::size_t tick);

/// One row as the estimator takes it; it refers to `recording`.
MeasuredSample sample_at(const Recording& recording, std::size_t row);

/// Whether a part of the model needs the recording's own derivatives, columns qd and qdd.
bool needs_derivatives(const TrainedModel& model);

/// Runs an estimator over samples as they come, and notes what it does. Keeps references to both.
class Replayer {
  public:
    /// `horizon`: T of the index ε, 0 for none.
    Replayer(HostEstimator& estimator, std::string source, std::size_t outputs, std::size_t horizon,
             const ReplayMemory& memory = {});

    /// One tick. `sample.output` is empty where nothing was measured.
    void tick(double time_s, const MeasuredSample& sample);
    /// Likewise, of a bus; `output` says why nothing was measured.
    void tick(double time_s, const MeasuredSample& sample, hal::Reason output);
    /// A tick for which a bus has no positions.
    void skip(double time_s, hal::Reason position);

    /// All that is kept; call once, last.
    ReplayedRecording finish();

  private:
    void estimate(double time_s, const MeasuredSample& sample);
    void append(const Tick& tick, std::span<const double> output);
    void complete_tick();
    template <class Use>
    void for_each_column(Use use);

    HostEstimator& estimator_;
    std::size_t outputs_, horizon_;
    HorizonError errors_;
    ReplayMemory memory_;
    ReplayedRecording replayed_;
};

/// Runs `estimator` over `recording`, learning on throughout; what it has learned before stays. `on_tick` is
/// told the number of ticks done. `models`: those that `estimator` was made of. `horizon`: T of the index ε,
/// 0 for none. Throws InputError when the recording has not the joints, outputs or derivatives of a model.
ReplayedRecording replay(HostEstimator& estimator, std::span<const TrainedModel> models,
                         const Recording& recording, std::size_t horizon,
                         const std::function<void(std::size_t)>& on_tick);

/// rms(measured - predicted) / std(measured) of one output over the ticks in [first, last) that are measured
/// and predicted; NaN if there are none.
double normalised_error(const ReplayedRecording& replayed, std::size_t outputs, std::size_t output,
                        std::size_t first, std::size_t last);

/// The share of measured and predicted ticks whose output lies within two standard deviations of its
/// prediction; NaN if there are none.
double share_within_two_deviations(const ReplayedRecording& replayed, std::size_t outputs,
                                   std::size_t output);

/// The median of ε of one output over the times t in [from_s, to_s) since the recording's start; NaN if there
/// are none. The median, because ε is relative: while an output rests near zero it is as large as one likes.
double median_horizon_index(const ReplayedRecording& replayed, std::size_t output, double from_s,
                            double to_s);

} // namespace dfdyn::tools
