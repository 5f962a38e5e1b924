// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/forecast_combination.hpp"
#include "tools/control/learned_feed_forward.hpp"
#include "tools/host/dynamic_storage.hpp"
#include "tools/simulation/arm_dynamics.hpp"
#include "tools/simulation/task.hpp"

#include <optional>

namespace dfdyn::tools {

/// The torque that the reference takes: of the nominal rigid body, and of a learned model beside it.
///
/// Both are computed once per sample period of the learned model (a *knot*) for the knot to come, and
/// interpolated linearly between. Whose torque is used, joint by joint, the torque that was needed decides:
/// what was measured at a knot is compared with both forecasts for it, and they are combined as
/// dfdyn::ForecastCombination does, over the last second. Before a second has been judged it is the nominal
/// one alone. So a model that knows nothing yet, or has gone wrong, costs no accuracy.
class FeedForward {
  public:
    /// `learned`: none, or a model.
    FeedForward(const Robot& nominal, const JointVector& rotor_inertia,
                std::optional<LearnedFeedForward> learned, double knot_period_s);

    /// The motion begins at `start`, at rest, with the knot of `time_ns`.
    void begin(std::int64_t time_ns, const Reference& start);

    /// The measured position of a knot, and its torque: null where nothing was measured. Left out where the
    /// position is not known either.
    void measured(std::int64_t time_ns, const JointVector& position, const JointVector* torque);

    /// Work that a tick between two knots does.
    void go_on();

    /// Goes on to the next knot: its time and reference.
    void advance(std::int64_t next_ns, const Reference& next);

    /// N·m at a share 0 … 1 of the way from the knot before to the one that `advance` was given.
    JointVector torque(double share) const { return from_ + share * (to_ - from_); }

    /// What gravity takes at `position`, by the nominal rigid body.
    JointVector gravity(const JointVector& position);

    /// What brakes the arm along `reference`, or holds it there, N·m: by the nominal rigid body, and of the
    /// learned model's prediction at rest the share that it had when the motion ended. For a motion that has
    /// ended: call it once per tick. The learned part is renewed every few calls, each of which does one
    /// evaluation of the model at most; until the first it is that of the motion.
    JointVector holding(const Reference& reference);

    /// Share of the learned model in each joint's torque, 0 … 1.
    JointVector learned_share() const;
    const LearnedFeedForward* learned() const { return learned_ ? &*learned_ : nullptr; }

  private:
    JointVector nominal_torque(const Reference& reference);
    void judge(const JointVector& torque);
    bool trusted() const noexcept { return learned_ && judged_ >= memory_; }

    ArmDynamics dynamics_;
    ArmDynamics::Configuration configuration_;
    std::optional<LearnedFeedForward> learned_;
    int memory_; ///< knots of a second
    ForecastCombination<double, dynamic, dynamic> combination_;
    std::vector<double> forecasts_; ///< the nominal model's, then the learned one's
    int judged_ = 0;
    bool known_ = false; ///< whether the learned model had something to say of the knot at hand
    JointVector nominal_now_, learned_now_; ///< for the knot to come
    JointVector from_, to_;
    JointVector held_learned_; ///< of `holding`: learned part, as of the last evaluation; empty before
};

} // namespace dfdyn::tools
