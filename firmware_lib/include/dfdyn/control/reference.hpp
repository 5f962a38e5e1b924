// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"

namespace dfdyn {

/// Reference motion of the joints at one time.
template <class Scalar, int n>
struct Reference {
    Storage<Scalar, n> position;     ///< rad
    Storage<Scalar, n> velocity;     ///< rad/s
    Storage<Scalar, n> acceleration; ///< rad/s²
};

/// Returns the position, rad, of joint `joint` (from 0) after `time_s` (s) at constant acceleration. The
/// error is jerk · time³ / 6. O(1).
template <class Scalar, int n>
Scalar position_after(const Reference<Scalar, n>& reference, int joint, Scalar time_s) noexcept {
    return reference.position[joint] +
           time_s * (reference.velocity[joint] + time_s / 2 * reference.acceleration[joint]);
}

} // namespace dfdyn
