// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/loop/position_feedback.hpp"
#include "tools/control/loop/safe_stop.hpp"

#include <vector>

namespace dfdyn::tools {

/// Looks for joints that do what they must not, from their readings, the reference and the commands:
/// - overspeed: the speed of more than `speed_patience` readings in a row is beyond the limit.
/// - torque_limit: the command was at its limit for more than `pressing_ticks`, within which the joint moved
///   by less than a tenth of the following error.
/// - frozen_encoder: the same reading, to the last bit, more than `frozen_patience` times in a row after the
///   joint must have moved. It must have where it was too fast before to have stopped within two
///   quantisation steps (the smallest step seen so far) and four noise bounds of the velocity's filter, at
///   an eighth of `acceleration`. It also must have where the reference has since covered a sixteenth of the
///   following error and eight quantisation steps. Where the speed shows it, the repeated readings are not
///   used: see `repeated`.
/// O(joints) per tick; no heap after construction.
class JointWatch {
  public:
    JointWatch(SafeStopConfig config, double period_s, double noise_bound);

    /// Looks at a new reading, before the feedback takes it; `reference`: position at the same instant.
    /// `missing`: joints without a reading, which are left out.
    void read(const JointVector& position, const JointVector& reference, const PositionFeedback& feedback,
              const std::vector<bool>& missing);

    /// Looks at the speed after the feedback took the reading, and at the command of the tick before.
    void move(const PositionFeedback& feedback, const JointVector& command);

    /// Joints whose last reading repeats where it cannot.
    const std::vector<bool>& repeated() const noexcept { return repeated_; }

    /// What was found, none where all is well. For the joint's number, from 0: see `joint`.
    StopCause cause() const noexcept { return cause_; }
    Eigen::Index joint() const noexcept { return joint_; }

  private:
    void found(StopCause cause, Eigen::Index joint) noexcept;
    void repeat(Eigen::Index joint, double reference, double speed) noexcept;
    bool must_have_moved(Eigen::Index joint) const noexcept;

    SafeStopConfig config_;
    double period_s_, noise_bound_;
    bool started_ = false;
    JointVector reading_, speed_;                     ///< where the reading last changed
    JointVector lowest_, highest_;                    ///< reference since then
    JointVector quantum_;                             ///< smallest step seen; 0 before the first
    JointVector pressing_position_;                   ///< where the joint began to press
    std::vector<int> same_, stuck_, fast_, pressing_; ///< readings or ticks in a row, per joint
    std::vector<bool> repeated_;
    StopCause cause_ = StopCause::none;
    Eigen::Index joint_ = 0;
};

} // namespace dfdyn::tools
