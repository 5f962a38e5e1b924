// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/dynamic_storage.hpp"
#include "tools/monitor/monitored_estimator.hpp"
#include "tools/replay/contacts/contact_estimator.hpp"
#include "tools/robot/dynamics/joint_vector.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Torque of a joint that dfdyn::FeedForward and dfdyn::DisturbanceObserver are to leave out.
inline constexpr double unknown_torque = std::numeric_limits<double>::quiet_NaN();

/// Statistics of the learner.
struct LearningCounters {
    std::uint64_t samples = 0; ///< offered
    std::uint64_t learned = 0;
    std::uint64_t faults = 0;            ///< rejected as faulty (dfdyn::is_fault)
    Reason last_fault = Reason::ok;      ///< of the last rejected sample
    std::uint64_t reference_unknown = 0; ///< references without a prediction
};

/// Throws InputError, naming `source`, for a model that does not describe the torques of `joints` joints, or
/// that needs measured derivatives.
void check_loop_model(const TrainedModel& model, int joints, const std::string& source);

/// A learned model of the joint torques as feed-forward. It learns from windows of measured positions and is
/// evaluated on a window of the reference. Two estimators of the same model are used: one learns, and the
/// other, its follower, always has the first one's weights. The command therefore depends on the reference,
/// without the encoders' noise and delay, and the weights depend on the measured motion.
///
/// For a model with features and learned physics (SPK) two more such pairs learn the physics alone, with the
/// memories `physics_memories_s` and without innovation gate. Their forecasts come after the first one. They
/// have few parameters: with the short memory they are accurate within a second after a change of the arm,
/// before the features are, and with the long one wherever the physics is all there is to learn. They predict
/// also where the features' arguments are out of range. They start from the prior, also after `restore`.
///
/// The work for one sample is distributed over the control ticks until the next sample, with a bounded share
/// per tick. This is the host's counterpart of dfdyn::LearnedTorque (a dfdyn::TorqueLearner), for models of
/// any size.
class LearnedFeedForward {
  public:
    using Scalar = double;
    static constexpr int outputs = dynamic;
    static constexpr int forecasts = dynamic;
    /// Memories of the learners of the physics alone. The short one was chosen on the iCub's arm with
    /// tripled friction (docs/results/loop.md); the long one is that of the least squares of that page, and
    /// not tuned.
    static constexpr std::array physics_memories_s{0.53, 8.0};

    /// `from_prior`: ignores the initial weights from training. `ticks`: control ticks per sample. `monitor`:
    /// monitors the learner; null for none. `contact`: for the detection of contacts, in which nothing is
    /// learned; null for none. Throws InputError as `check_loop_model`.
    LearnedFeedForward(const TrainedModel& model, bool from_prior, int joints, int ticks,
                       const std::string& source, const MonitorSetup* monitor = nullptr,
                       const ContactSetup* contact = nullptr);

    Extent<dynamic> output_count() const noexcept { return {static_cast<int>(prediction_.size())}; }
    /// Returns 1, and one more per learner of the physics alone.
    Extent<dynamic> forecast_count() const noexcept { return {static_cast<int>(learners_.size())}; }

    /// Restarts both windows for an arm that has been at rest at `position` (one value per joint, rad) for a
    /// long time; `time_ns`: the present time.
    void begin(std::int64_t time_ns, const double* position);

    /// Sets whether `learn` may learn the next samples, or only compares them with the model: for contacts
    /// and findings.
    void may_learn(bool may) noexcept { may_learn_ = may; }
    /// Begins to learn the measurement at one time; `torque`: null if only the position was measured.
    void learn(std::int64_t time_ns, const double* position, const double* torque);

    /// Continues the learning; once in each control tick.
    void go_on();

    /// Predicts the torque (N·m) of the reference at `time_ns`, one sample period after the previous call:
    /// the torques of each forecast; NaN without a valid prediction. Returns false if none has one.
    bool predict(std::int64_t time_ns, const double* reference, double* torque);

    /// Predicts the torque (N·m) that holds the arm at rest at `position`, after the motion has ended. Each
    /// call adds one sample to the window. The call that completes the window returns the forecasts as
    /// `predict` writes them, for the position of the first of these calls, if one is valid, and starts the
    /// next window. The other calls return nothing. The result is valid until the next call.
    std::span<const double> rest(const JointVector& position);

    /// Returns the learned state in the firmware's format, to continue after a restart.
    std::vector<std::byte> snapshot() const { return learners_.front().estimator->snapshot(); }
    /// Restores a snapshot. Returns false, without any change, if it does not match this model.
    bool restore(std::span<const std::byte> snapshot);

    /// Maximum number of multiply-adds in a control tick.
    std::int64_t tick_cost() const;
    const LearningCounters& counters() const noexcept { return counters_; }
    /// Returns the monitor's last verdict, once; null if there is none.
    const Verdict* take_verdict() { return monitor_ != nullptr ? monitor_->take_verdict() : nullptr; }
    /// Returns the joint (from 0) of the present contact; -1: none, or contacts are not detected.
    int contact_joint() const {
        return contacts_ != nullptr && contacts_->detector().contact() ? contacts_->detector().joint() : -1;
    }
    /// Returns the calibration of the limits of contacts; null: none.
    const ContactWatch::Calibration* contact_calibration() const {
        return contacts_ != nullptr ? contacts_->calibration() : nullptr;
    }
    /// Resets the covariance after a change of the arm: see RuntimeEstimator::relearn.
    void relearn() { learners_.front().estimator->relearn(); }
    /// Returns the monitor's findings so far, with times since `begin`, as those of the recording `run`.
    RecordedChanges changes(const std::string& run) const;

  private:
    /// An estimator that learns in slices, and its follower.
    struct Learner {
        std::unique_ptr<RuntimeEstimator> estimator;
        std::unique_ptr<RuntimeEstimator> follower; ///< of the reference
        Budget share;                               ///< budget of a control tick
        std::vector<float> weights;                 ///< learned last
        bool in_progress = true; ///< the estimator has weights that are newer than `weights`
        bool follows = false;    ///< the follower can predict the newest reference

        Learner(std::unique_ptr<RuntimeEstimator> learning, std::unique_ptr<RuntimeEstimator> following,
                int ticks);
        Status learn(const MeasuredSample& sample, bool may_learn);
        void go_on();
        void take_over();
    };

    /// Adds a reference to the windows of the followers.
    void follow(std::int64_t time_ns, const double* reference);
    /// Predicts for the newest reference; false, and NaN, if that or the prediction exceeds the model's
    /// bounds.
    bool take_prediction(const Learner& learner, double* torque);
    /// Writes each learner's prediction. Returns false if none is valid.
    bool take_forecasts(double* torque);
    std::span<const double> of_joints(const double* values) const { return {values, prediction_.size()}; }

    std::int64_t sample_period_ns_;
    int lags_;
    std::vector<Learner> learners_;         ///< of the model, then of the physics alone, one per memory
    MonitoredEstimator* monitor_ = nullptr; ///< the learner, if it is monitored
    ContactEstimator* contacts_ = nullptr;  ///< the learner, if contacts are detected
    bool may_learn_ = true;
    std::int64_t begin_ns_ = 0;
    std::vector<float> prediction_;
    int rest_lag_ = 0; ///< samples already added to the window by `rest`
    JointVector rest_position_;
    std::vector<double> forecasts_at_rest_;
    LearningCounters counters_;
};

} // namespace dfdyn::tools
