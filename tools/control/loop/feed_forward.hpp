// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/control/feed_forward.hpp"
#include "tools/control/loop/learned_feed_forward.hpp"
#include "tools/robot/dynamics/arm_dynamics.hpp"
#include "tools/simulation/task/task.hpp"

#include <memory>
#include <optional>
#include <span>

namespace dfdyn::tools {

/// The torque that the reference takes: of the nominal rigid body, and of a learned model beside it, as
/// dfdyn::FeedForward puts them together. What is learned changes by the torque limit in 0.05 s at most.
class FeedForward {
  public:
    /// `learned`: none, or a model; `knot_ticks`: ticks of its sample period. `limit`: of each joint's
    /// torque, N·m; `learned_limit`: of what is learned beside the nominal rigid body.
    FeedForward(const Robot& nominal, const JointVector& rotor_inertia,
                std::optional<LearnedFeedForward> learned, double period_s, int knot_ticks,
                const JointVector& limit, const JointVector& learned_limit);

    /// Uses what is learned, or leaves it out; without a step in either case. It is learned in both.
    void enable_learned(bool on) noexcept;

    /// The motion begins at `start`, at rest.
    void begin(std::int64_t time_ns, const Reference& start);

    /// N·m, of this tick's reference; once per tick.
    JointVector update(const Reference& reference);

    /// What was commanded in this tick, N·m; after `update`.
    void commanded(const JointVector& torque);

    /// The newest measured position, and the torque that was in effect then; null for what is not known. Once
    /// per tick.
    void measured(std::int64_t time_ns, const JointVector* position, const JointVector* torque);

    /// The joints' own inertias in the posture of the last knot, kg·m²: diagonal of the nominal mass matrix.
    const JointVector& inertia() const noexcept { return inertia_; }

    /// What gravity takes at `position`, by the nominal rigid body.
    JointVector gravity(const JointVector& position);

    /// What brakes the arm along `reference`, or holds it there, N·m: by the nominal rigid body, and of the
    /// learned model's prediction at rest the share that it had when the motion ended. For a motion that has
    /// ended: call it once per tick. The learned part is renewed every few calls, each of which does one
    /// evaluation of the model at most; until the first it is that of the motion.
    JointVector holding(const Reference& reference);

    /// The monitor's last verdict, once; null: none.
    const Verdict* take_verdict() { return learned_ ? learned_->take_verdict() : nullptr; }

    /// What has been learned is to follow what is measured from now on.
    void relearn() {
        if (learned_) {
            learned_->relearn();
        }
    }

    /// Adds `torque` to the nominal torque for good, gradually (time constant `compensation_s`); at most as
    /// much as what is learned may add. N·m, a value per joint.
    void compensate(std::span<const double> torque);

    /// Share of the learned model in each joint's torque, 0 … 1.
    JointVector learned_share() const;
    const LearnedFeedForward* learned() const { return learned_.get(); }

  private:
    using Core = dfdyn::FeedForward<LearnedFeedForward>;

    static constexpr double compensation_s = 0.5;

    JointVector nominal_torque(const Reference& reference);

    ArmDynamics dynamics_;
    ArmDynamics::Configuration configuration_;
    int knot_ticks_;
    JointVector cap_; ///< of what is learned, N·m
    double period_s_;
    JointVector compensation_, wanted_compensation_; ///< N·m: present, in the end
    long tick_ = 0;
    std::unique_ptr<LearnedFeedForward> learned_; ///< stays where it is: the core refers to it
    std::optional<Core> core_;
    dfdyn::Reference<double, dynamic> reference_;
    JointVector inertia_;
    JointVector held_learned_; ///< of `holding`: learned part, as of the last evaluation; empty before
};

} // namespace dfdyn::tools
