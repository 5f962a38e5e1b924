// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/features/cos_sin.hpp" // faster than the C library where speed matters
#include "joint_controller.hpp"

#include <cmath>
#include <numbers>

/// Simulates six joints with inertia, gravity and friction that differ from those of the training data, and
/// provides a reference motion for them.
class SimulatedJoints {
  public:
    static constexpr int joints = JointController::joints;
    static constexpr float inertia = 0.2F; // A·s²/rad
    static constexpr float weight = 1;     // A
    static constexpr float coulomb = 0.8F; // A
    static constexpr float viscous = 0.5F; // A·s/rad
    static constexpr float period_s = 1e-9F * JointController::period_ns;

    /// Starts at rest at the beginning of the motion.
    SimulatedJoints() {
        const JointController::Reference start = reference(0);
        for (int k = 0; k < joints; ++k) {
            state_.position[k] = start.position[k];
        }
    }

    /// Returns the reference: a periodic motion that starts from rest.
    static JointController::Reference reference(std::int64_t tick) {
        JointController::Reference reference{};
        constexpr float rate = 2.5F; // rad/s
        // reduced in double: a float loses the angle after an hour
        const double turned =
            static_cast<double>(rate) * 1e-9 * JointController::period_ns * static_cast<double>(tick);
        const auto angle = static_cast<float>(std::remainder(turned, 2 * std::numbers::pi));
        float cosine = 1;
        float sine = 0;
        dfdyn::cos_sin(&angle, 1, 1.0F, &cosine, &sine);
        for (int k = 0; k < joints; ++k) {
            const float size = 0.2F + 0.05F * static_cast<float>(k);
            reference.position[k] = size * (1 - cosine);
            reference.velocity[k] = size * rate * sine;
            reference.acceleration[k] = size * rate * rate * cosine;
        }
        return reference;
    }

    /// Returns the nominal effort of a model that contains only the inertia.
    static JointController::Efforts nominal(const JointController::Reference& reference) {
        JointController::Efforts effort{};
        for (int k = 0; k < joints; ++k) {
            effort[k] = inertia * reference.acceleration[k];
        }
        return effort;
    }

    /// Simulates one period with constant efforts, A, in short integration steps.
    void advance(const JointController::Efforts& effort) {
        constexpr int steps = 4;
        constexpr float step_s = period_s / steps;
        for (int k = 0; k < joints; ++k) {
            for (int i = 0; i < steps; ++i) {
                const float net = effort[k] - friction(state_.velocity[k]) - weight * state_.position[k];
                state_.velocity[k] += step_s / inertia * net;
                state_.position[k] += step_s * state_.velocity[k];
            }
        }
        state_.time_ns += JointController::period_ns;
    }

    [[nodiscard]] const JointController::State& state() const { return state_; }

  private:
    /// Returns Coulomb and viscous friction, A; smooth near zero velocity, so that longer steps are stable.
    static float friction(float velocity) {
        constexpr float slow = 0.01F; // rad/s
        return coulomb * velocity / (slow + std::abs(velocity)) + viscous * velocity;
    }

    JointController::State state_{};
};
