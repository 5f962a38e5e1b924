// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/lugre_friction.hpp"

#include <cmath>

namespace dfdyn::tools {

double LuGreFriction::level(double velocity) const noexcept {
    const double ratio = velocity / parameters_.stribeck_velocity;
    return parameters_.coulomb + (parameters_.breakaway - parameters_.coulomb) * std::exp(-ratio * ratio);
}

double LuGreFriction::deflection_rate(double velocity) const noexcept {
    return velocity - parameters_.stiffness * std::abs(velocity) / level(velocity) * deflection_;
}

double LuGreFriction::torque(double velocity) const noexcept {
    if (!(parameters_.stiffness > 0)) {
        return parameters_.viscous * velocity;
    }
    return parameters_.stiffness * deflection_ + parameters_.damping * deflection_rate(velocity) +
           parameters_.viscous * velocity;
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
