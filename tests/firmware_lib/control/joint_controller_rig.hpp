// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "examples/03_control_loop/simulated_joints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace joint_controller_test {

constexpr JointController::Gains gains{
    .position = 80, .velocity = 8, .inertia = 0.2F, .limit = 15, .bandwidth = 30};
constexpr float largest_step = JointController::step_share * gains.limit;
constexpr float nothing = std::numeric_limits<float>::quiet_NaN();
constexpr int joint = 2;

/// The controller with its simulated arm; `pass` may change the measurement on its way.
class Rig {
  public:
    Rig() { controller.activate(joints_.state()); }

    template <class Pass>
    void go(int ticks, Pass pass) {
        largest_change = 0;
        for (int i = 0; i < ticks; ++i) {
            JointController::Reference reference = SimulatedJoints::reference(tick_++);
            JointController::State state = joints_.state();
            pass(state);
            const JointController::Efforts nominal = SimulatedJoints::nominal(reference);
            reference.position[joint] += reference_offset;
            effort_ = controller.update(state, reference, nominal, applied);
            for (int k = 0; k < JointController::joints; ++k) {
                const float now = effort_[k] - nominal[k] - controller.forward().learned_part()[k];
                largest_change = std::max(largest_change, std::abs(now - correction[k]));
                correction[k] = now;
            }
            joints_.advance(applied ? effort_ : JointController::Efforts{});
        }
    }
    void go(int ticks) {
        go(ticks, [](JointController::State& /*state*/) {});
    }

    /// The arm goes on with the last efforts, and the controller is not called.
    void sleep(int ticks) {
        for (int i = 0; i < ticks; ++i) {
            joints_.advance(effort_);
        }
    }

    JointController controller{gains};
    JointController::Efforts correction{}; ///< of feedback and observer in the last tick, A
    float largest_change = 0;              ///< of a correction in a tick of the last call of `go`, A
    float reference_offset = 0;            ///< of `joint`, rad
    bool applied = true;                   ///< otherwise the arm stays where it begins

  private:
    SimulatedJoints joints_;
    JointController::Efforts effort_{};
    long tick_ = 0;
};

} // namespace joint_controller_test
