// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/host/host_estimator.hpp"
#include "tools/simulation/joint_vector.hpp"

#include <cstdint>
#include <memory>
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
class LearnedFeedForward {
  public:
    /// `from_prior`: without the start that training computed. Throws InputError, naming `source`, for a
    /// model that is not of `joints` joints and their torques, or needs measured derivatives.
    LearnedFeedForward(const TrainedModel& model, bool from_prior, int joints, const std::string& source);

    /// The arm rests at `position`, and has long since; `time_ns`: of now. Restarts both windows.
    void begin(std::int64_t time_ns, const JointVector& position);

    /// Learns what was measured at one instant.
    void learn(std::int64_t time_ns, const JointVector& position, const JointVector& torque);

    /// What torque the reference takes at `time_ns`, a sample period after the last: true and N·m, or false
    /// where the model does not know.
    bool predict(std::int64_t time_ns, const JointVector& reference, JointVector& torque);

    double sample_period_s() const noexcept { return sample_period_s_; }
    /// Multiply-adds of a learn and a predict, at most.
    std::int64_t cost() const { return learner_->cost().learn + 2 * learner_->cost().predict; }
    const LearningCounters& counters() const noexcept { return counters_; }

  private:
    double sample_period_s_;
    int lags_;
    std::unique_ptr<HostEstimator> learner_, follower_;
    std::vector<float> weights_, prediction_;
    LearningCounters counters_;
};

} // namespace dfdyn::tools
