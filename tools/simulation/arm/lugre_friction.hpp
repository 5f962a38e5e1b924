// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dfdyn::tools {

/// Friction of one joint, of C. Canudas de Wit, H. Olsson, K. J. Astrom and P. Lischinsky, "A new model for
/// control of systems with friction", IEEE Trans. Automatic Control 40(3), 1995. Torques in N·m for revolute
/// joints, forces in N for prismatic ones, velocities in rad/s or m/s.
struct LuGreParameters {
    double stiffness = 0;         ///< σ0 of the bristles, N·m/rad; 0: neither Coulomb nor static friction
    double damping = 0;           ///< σ1 of the bristles, N·m·s/rad
    double viscous = 0;           ///< σ2, N·m·s/rad
    double coulomb = 0;           ///< kinetic friction, N·m
    double breakaway = 0;         ///< static friction, N·m; at least `coulomb`
    double stribeck_velocity = 1; ///< rad/s, positive
    double negative_excess = 0;   ///< N·m: how much higher the level is while the joint moves backwards
    double load_coefficient = 0;  ///< N·m of level per N·m of load, either sign of load alike; only without
                                  ///< damping, which would blow up where the load vanishes
    double drift_per_s = 0;       ///< 1/s: relative change of level and viscous friction since t = 0
};

/// The friction's own state: the mean deflection of the bristles. Equations, with v the joint's velocity:
/// z' = v - σ0 |v| z / g(v),  g(v) = coulomb + (breakaway - coulomb) exp(-(v / stribeck_velocity)²),
/// friction = σ0 z + σ1 z' + σ2 v. The level g has additions: an excess for negative v, a share of the load's
/// magnitude; without the latter it drifts in time, and with it σ2.
class LuGreFriction {
  public:
    explicit LuGreFriction(const LuGreParameters& parameters) noexcept : parameters_(parameters) {}

    /// From now on: the time, and the torque that the joint's gear passes on.
    void set_conditions(double time_s, double load) noexcept;

    /// From now on levels and viscous friction are `factor` times what the parameters say.
    void set_factor(double factor) noexcept { factor_ = factor; }

    /// What opposes the motion at `velocity`.
    double torque(double velocity) const noexcept;

    /// Moves the bristles on by `duration` (s) of constant velocity: the exact solution, stable for any
    /// stiffness.
    void advance(double velocity, double duration) noexcept;

    double deflection() const noexcept { return deflection_; }

  private:
    double level(double velocity) const noexcept;
    double deflection_rate(double velocity) const noexcept;

    LuGreParameters parameters_;
    double deflection_ = 0;
    double drifted_ = 1; ///< times what it was at t = 0, never negative
    double load_ = 0;    ///< N·m, magnitude
    double factor_ = 1;
};

} // namespace dfdyn::tools
