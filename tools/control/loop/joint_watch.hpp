// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/loop/position_feedback.hpp"
#include "tools/control/loop/safe_stop.hpp"

#include <vector>

namespace dfdyn::tools {

/// Detects abnormal behaviour of joints from their readings, the reference and the commands:
/// - overspeed: the speed exceeds the limit in more than `speed_patience` successive readings.
/// - torque_limit: the command is at its limit for more than `pressing_ticks`, while the joint moves by less
///   than a tenth of the following error.
/// - frozen_encoder: more than `frozen_patience` successive readings are bit-identical although the joint
///   must have moved.
///
/// Either of two conditions shows that a joint must have moved:
/// - Speed: with an eighth of `acceleration` it could not stop within two quantization steps (the smallest
///   step so far) plus four noise bounds of the filter. The speed is the smaller one of the
///   present velocity and its mean over ten readings: a joint that vibrates or sticks has a velocity, too.
///   The repeated readings are then not used: see `repeated`.
/// - Reference: it has since covered eight quantization steps and `sticking`, so that friction cannot hold
///   the joint against the feedback.
///
/// O(joints) per tick; no heap after construction.
class JointWatch {
  public:
    JointWatch(SafeStopConfig config, double period_s);

    /// Evaluates a new reading before the feedback uses it; `reference`: position at the same time.
    /// `missing`: joints without a reading, which are skipped.
    void read(const JointVector& position, const JointVector& reference, const PositionFeedback& feedback,
              const std::vector<bool>& missing);

    /// Adds `distance` to the references so far, so that a moved reference does not count as its motion.
    void move_reference(const JointVector& distance) {
        lowest_ += distance;
        highest_ += distance;
    }

    /// Evaluates the speed after the feedback has used the reading, and the previous tick's command.
    void move(const PositionFeedback& feedback, const JointVector& command);

    /// Joints whose last reading repeats although the joint must have moved.
    const std::vector<bool>& repeated() const noexcept { return repeated_; }

    /// The detected cause, or none. For the joint's number (from 0) see `joint`.
    StopCause cause() const noexcept { return cause_; }
    Eigen::Index joint() const noexcept { return joint_; }

  private:
    static constexpr int most_same = 1'000'000'000; ///< readings

    void found(StopCause cause, Eigen::Index joint) noexcept;
    void repeat(Eigen::Index joint, double reference, const PositionFeedback& feedback) noexcept;
    double steady_speed(Eigen::Index joint, double velocity) const noexcept;
    bool must_have_moved(Eigen::Index joint, double tolerance) const noexcept;

    SafeStopConfig config_;
    double period_s_;
    JointVector reading_, speed_; ///< at the last change of the reading; NaN before the first
    JointVector mean_velocity_;
    JointVector lowest_, highest_;                    ///< range of the reference since then
    JointVector pressing_position_;                   ///< position when the command reached its limit
    std::vector<int> same_, stuck_, fast_, pressing_; ///< successive readings or ticks, per joint
    std::vector<bool> repeated_;
    StopCause cause_ = StopCause::none;
    Eigen::Index joint_ = 0;
};

} // namespace dfdyn::tools
