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
    double negative_excess = 0;   ///< N·m: additional level while the joint moves backwards
    /// N·m of level per N·m of load, for either sign of the load; only without damping, which would become
    /// unbounded at zero load
    double load_coefficient = 0;
    double drift_per_s = 0; ///< 1/s: relative change of level and viscous friction since t = 0
};

/// LuGre friction; its state is the mean deflection z of the bristles. Equations, with v the joint's
/// velocity:
/// z' = v - σ0 |v| z / g(v),  g(v) = coulomb + (breakaway - coulomb) exp(-(v / stribeck_velocity)²),
/// friction = σ0 z + σ1 z' + σ2 v.
///
/// The level g has additional terms: an excess for negative v and a share of the load's magnitude. Level
/// (without the load term) and σ2 drift with time.
class LuGreFriction {
  public:
    explicit LuGreFriction(const LuGreParameters& parameters) noexcept : parameters_(parameters) {}

    /// Sets the time and the torque that the joint's gear transmits.
    void set_conditions(double time_s, double load) noexcept;

    /// Multiplies the levels and the viscous friction of the parameters by `factor`, from 0. With a smaller
    /// factor than before, bristles beyond the new break-away level slip back to it at once.
    void set_factor(double factor) noexcept;

    /// Returns the friction torque, which opposes the motion at `velocity`.
    double torque(double velocity) const noexcept;

    /// Advances the bristles by `duration` (s) at constant velocity. The solution is exact and stable for any
    /// stiffness.
    void advance(double velocity, double duration) noexcept;

    double deflection() const noexcept { return deflection_; }

  private:
    double level(double velocity) const noexcept;
    double deflection_rate(double velocity) const noexcept;

    LuGreParameters parameters_;
    double deflection_ = 0;
    double drifted_ = 1; ///< factor relative to t = 0, never negative
    double load_ = 0;    ///< N·m, magnitude
    double factor_ = 1;
};

} // namespace dfdyn::tools
