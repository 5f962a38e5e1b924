// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/storage.hpp"

namespace dfdyn {

/// What the joints are to do at one instant.
template <class Scalar, int n>
struct Reference {
    Storage<Scalar, n> position;     ///< rad
    Storage<Scalar, n> velocity;     ///< rad/s
    Storage<Scalar, n> acceleration; ///< rad/s²
};

/// Position of joint `joint` a short time later, at constant acceleration, rad. Its error is a sixth of the
/// jerk times the third power of the time.
template <class Scalar, int n>
Scalar position_after(const Reference<Scalar, n>& reference, int joint, Scalar time_s) noexcept {
    return reference.position[joint] +
           time_s * (reference.velocity[joint] + time_s / 2 * reference.acceleration[joint]);
}

} // namespace dfdyn
