// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/dynamic_storage.hpp"
#include "tools/monitor/monitored_estimator.hpp"
#include "tools/robot/dynamics/joint_vector.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// What the learner did so far.
struct LearningCounters {
    std::uint64_t samples = 0; ///< offered
    std::uint64_t learned = 0;
    std::uint64_t faults = 0;            ///< refused as faulty (dfdyn::is_fault)
    Reason last_fault = Reason::ok;      ///< of them
    std::uint64_t reference_unknown = 0; ///< references for which nothing was predicted
};

/// A learned model of the joints' torques as feed-forward. It learns from windows of measured positions, and
/// is evaluated on a window of the reference's: two estimators of the same model, one that learns and one
/// whose weights are always the first one's. So the command follows from what the arm is to do, free of the
/// encoders' noise and lag, and what is learned from what it did.
///
/// Learning a sample is spread over the control ticks until the next one: each does at most its share. The
/// host's counterpart of dfdyn::LearnedTorque (a dfdyn::TorqueLearner), for models of any size.
class LearnedFeedForward {
  public:
    using Scalar = double;
    static constexpr int outputs = dynamic;

    /// `from_prior`: without the start that training computed. `ticks`: of control per sample. Throws
    /// InputError, naming `source`, for a model that is not of `joints` joints and their torques, or needs
    /// measured derivatives.
    /// `monitor`: watches the learner; none without.
    LearnedFeedForward(const TrainedModel& model, bool from_prior, int joints, int ticks,
                       const std::string& source, const MonitorSetup* monitor = nullptr);

    Extent<dynamic> output_count() const noexcept { return {static_cast<int>(prediction_.size())}; }

    /// The arm rests at `position` (a value per joint, rad), and has long since; `time_ns`: of now. Restarts
    /// both windows.
    void begin(std::int64_t time_ns, const double* position);

    /// Begins to learn what was measured at one instant; `torque`: null where only the position was.
    void learn(std::int64_t time_ns, const double* position, const double* torque);

    /// Goes on learning it; once in each control tick.
    void go_on();

    /// What torque the reference takes at `time_ns`, a sample period after the last: true and N·m, or false
    /// where the model does not know.
    bool predict(std::int64_t time_ns, const double* reference, double* torque);

    /// What torque holds the arm at rest at `position`, once the motion has ended: each call takes one of the
    /// window's samples; the call that completes it writes `torque`, N·m, of the position at the first of
    /// these calls, and returns true where the model knows it. Then the next window begins.
    bool rest(const JointVector& position, JointVector& torque);

    /// What has been learned, to go on from at another start, in the firmware's format.
    std::vector<std::byte> snapshot() const { return learner_->snapshot(); }
    /// Back to that; false, and nothing changed, when it is not one of this model.
    bool restore(std::span<const std::byte> snapshot);

    /// Multiply-adds of a control tick, at most.
    std::int64_t tick_cost() const;
    const LearningCounters& counters() const noexcept { return counters_; }
    /// The monitor's last verdict, once; null: none.
    const Verdict* take_verdict() { return monitor_ != nullptr ? monitor_->take_verdict() : nullptr; }
    /// The arm has changed: see HostEstimator::relearn.
    void relearn() { learner_->relearn(); }
    /// What the monitor found so far, with times since `begin`.
    RecordedChanges changes() const;

  private:
    void take_over();
    /// Of the follower's columns; false where it is beyond the model's bounds.
    bool take_prediction(double* torque);
    std::span<const double> of_joints(const double* values) const { return {values, prediction_.size()}; }

    std::int64_t sample_period_ns_;
    int lags_;
    std::unique_ptr<HostEstimator> learner_, follower_;
    MonitoredEstimator* monitor_ = nullptr; ///< the learner, if it is watched
    Budget share_;                          ///< of a control tick
    std::int64_t begin_ns_ = 0;
    bool in_progress_ = false; ///< the learner knows more than `weights_`
    std::vector<float> weights_, prediction_;
    int rest_lag_ = 0; ///< samples of the window that `rest` fills
    JointVector rest_position_;
    LearningCounters counters_;
};

} // namespace dfdyn::tools
