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

/// Returns one torque per joint for the library's controllers.
Storage<double, dynamic> torques(const JointVector& values);
/// The reverse.
JointVector joint_vector(const Storage<double, dynamic>& values);

/// Torque for the reference: the torque of the nominal rigid body plus a learned torque, combined as in
/// dfdyn::FeedForward. The learned part changes by at most the torque limit in 0.05 s.
class FeedForward {
  public:
    /// `learned`: an optional model; `knot_ticks`: ticks of its sample period. `limit`: of each joint's
    /// torque, N·m; `learned_limit`: of the learned torque in addition to the nominal rigid body.
    /// `bandwidth`: of the loop's disturbance observer, rad/s per joint; 0: none. `observer_limit`: of its
    /// torque, N·m.
    FeedForward(const Robot& nominal, const JointVector& rotor_inertia,
                std::optional<LearnedFeedForward> learned, double period_s, int knot_ticks,
                const JointVector& limit, const JointVector& learned_limit, const JointVector& bandwidth,
                const JointVector& observer_limit);

    /// Enables or disables the learned torque, without a step. Learning continues in both states.
    void enable_learned(bool on) noexcept;

    /// Takes what vibrations left of the observer's bandwidth, 0 to 1 per joint.
    void observer_bandwidth_share(const Storage<double, dynamic>& share);

    /// Begins the motion at `start`, at rest.
    void begin(std::int64_t time_ns, const Reference& start);

    /// Computes the torque (N·m) of this tick's reference; once per tick.
    JointVector update(const Reference& reference);

    /// Registers the command (N·m) of this tick; after `update`.
    void commanded(const JointVector& torque);

    /// Registers the newest measured position and the torque in effect at its time; null if unknown. With
    /// `may_learn` false the sample is compared with the model but not learned. Once per tick.
    void measured(std::int64_t time_ns, const JointVector* position, const JointVector* torque,
                  bool may_learn);

    /// Diagonal of the nominal mass matrix at the last knot's position, kg·m².
    const JointVector& inertia() const noexcept { return inertia_; }

    /// Gravity torque at `position`, by the nominal rigid body.
    JointVector gravity(const JointVector& position);

    /// Computes the torque (N·m) that brakes the arm along `reference` or holds it there: the torque of the
    /// nominal rigid body plus the learned forecasts at rest, with the weights and share at the end of the
    /// motion. Call it once per tick, only after a motion has ended. The learned part is updated every few
    /// calls, with at most one evaluation of the model per call. Until the first update it is the motion's
    /// last learned part.
    JointVector holding(const Reference& reference);

    /// Returns the monitor's last verdict, once; null if there is none.
    const Verdict* take_verdict() { return learned_ ? learned_->take_verdict() : nullptr; }

    /// Returns the joint (from 0) of the present contact; -1: none, or contacts are not detected.
    int contact_joint() const { return learned_ ? learned_->contact_joint() : -1; }

    /// Resets the learner's covariance, so that it quickly adapts to new measurements.
    void relearn() {
        if (learned_) {
            learned_->relearn();
        }
    }

    /// Adds `torque` (N·m, one value per joint) to the nominal torque permanently, with time constant
    /// `compensation_s`. It has the same limit as the learned torque.
    void compensate(std::span<const double> torque);

    /// Share of the learned model in each joint's torque, 0 to 1.
    JointVector learned_share() const;
    const LearnedFeedForward* learned() const { return learned_.get(); }

  private:
    using Core = dfdyn::FeedForward<LearnedFeedForward>;

    static constexpr double compensation_s = 0.5;

    JointVector nominal_torque(const Reference& reference);

    ArmDynamics dynamics_;
    ArmDynamics::Configuration configuration_;
    int knot_ticks_;
    JointVector cap_; ///< limit of the learned torque, N·m
    double period_s_;
    JointVector compensation_, wanted_compensation_; ///< N·m: present and final value
    long tick_ = 0;
    std::unique_ptr<LearnedFeedForward> learned_; ///< on the heap, because the core refers to it
    std::optional<Core> core_;
    dfdyn::Reference<double, dynamic> reference_;
    JointVector inertia_;
    JointVector held_learned_; ///< learned part of `holding` at the last evaluation; empty before
};

} // namespace dfdyn::tools
