// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulated_joints.hpp"

/// The controller and a simulated arm. A computer calls `tick` in a loop, a Cortex-M in its timer interrupt.
class ClosedLoop {
  public:
    ClosedLoop()
        : controller_({.position = 80, .velocity = 8, .inertia = 0.2F, .limit = 15, .bandwidth = 30}) {
        controller_.activate(joints_.state());
        controller_.relearn(); // the simulated joints differ from those of the training
    }

    /// Computes the efforts of one period and simulates it.
    void tick() {
        const JointController::Reference reference = SimulatedJoints::reference(tick_++);
        const JointController::State& state = joints_.state();
        for (int k = 0; k < JointController::joints; ++k) {
            const float error = reference.position[k] - state.position[k];
            error_square_ += error * error;
        }
        joints_.advance(controller_.update(state, reference, SimulatedJoints::nominal(reference)));
    }

    /// Returns the root mean square tracking error over all joints and the `ticks` > 0 since the last call,
    /// rad.
    float take_error(int ticks) {
        const float mean = error_square_ / static_cast<float>(ticks * JointController::joints);
        error_square_ = 0;
        return std::sqrt(mean);
    }

    JointController& controller() { return controller_; }

  private:
    JointController controller_;
    SimulatedJoints joints_;
    std::int64_t tick_ = 0;
    float error_square_ = 0;
};
