// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/arm/lugre_friction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn::tools {

void LuGreFriction::set_conditions(double time_s, double load) noexcept {
    drifted_ = std::max(0.0, 1 + parameters_.drift_per_s * time_s);
    load_ = std::abs(load);
}

void LuGreFriction::set_factor(double factor) noexcept {
    const bool smaller = factor < factor_;
    factor_ = factor;
    if (smaller && parameters_.stiffness > 0) {
        // a deflection far above the level would make its rate, and with it the damping's torque, unbounded
        constexpr double backwards = -std::numeric_limits<double>::min();
        deflection_ = std::clamp(deflection_, -level(backwards) / parameters_.stiffness,
                                 level(0) / parameters_.stiffness);
    }
}

double LuGreFriction::level(double velocity) const noexcept {
    constexpr double least = 1e-9; // N·m; avoids a division by a level of zero
    const double ratio = velocity / parameters_.stribeck_velocity;
    const double unloaded = parameters_.coulomb +
                            (parameters_.breakaway - parameters_.coulomb) * std::exp(-ratio * ratio) +
                            (velocity < 0 ? parameters_.negative_excess : 0);
    return std::max(least, factor_ * (drifted_ * unloaded + parameters_.load_coefficient * load_));
}

double LuGreFriction::deflection_rate(double velocity) const noexcept {
    return velocity - parameters_.stiffness * std::abs(velocity) / level(velocity) * deflection_;
}

double LuGreFriction::torque(double velocity) const noexcept {
    if (!(parameters_.stiffness > 0)) {
        return factor_ * drifted_ * parameters_.viscous * velocity;
    }
    const double viscous = factor_ * drifted_ * parameters_.viscous;
    const double rate = deflection_rate(velocity);
    return parameters_.stiffness * deflection_ + parameters_.damping * rate + viscous * velocity;
}

void LuGreFriction::advance(double velocity, double duration) noexcept {
    if (!(parameters_.stiffness > 0) || velocity == 0) {
        return;
    }
    const double settled = std::copysign(level(velocity) / parameters_.stiffness, velocity);
    const double left = std::exp(-std::abs(velocity / settled) * duration);
    deflection_ = settled + (deflection_ - settled) * left;
}

} // namespace dfdyn::tools
