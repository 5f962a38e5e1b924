// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/physics/rigid_body.hpp"

namespace dfdyn {

inline constexpr int payload_columns = 4; ///< mass, first moment in the last link's frame
inline constexpr int force_columns = 3;   ///< force on the arm at a point of the last link, in the base frame

/// Derivatives of the outputs (N·m, N) by a body fixed to the last link, m × 4, and by a force on it at
/// `point` (m, in its frame), m × 3. `xi` as of `for_each_body`. O(n m): 250 multiply-adds per joint, 100 per
/// output.
template <class Arm, class Scalar>
void tool_columns(const typename Arm::template Constants<Scalar>& chain, const typename Arm::Sizes& sizes,
                  const Scalar* xi, const Scalar* point, Scalar* payload, Scalar* force) noexcept {
    Vector3<Scalar> axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; // of the base, in the link's frame
    for (int i = 0; i < sizes.joint_count; ++i) {
        const LinkFrame<Scalar> frame = detail::link_frame(chain.joint[i], xi[3 * i]);
        for (Vector3<Scalar>& axis : axes) {
            axis = frame.inward(axis);
        }
    }
    const auto visit = [&](int body, const LinkMotion<Scalar>& motion, const Screw<Scalar>* screws,
                           int count) {
        if (body + 1 < sizes.body_count) {
            return;
        }
        for (int k = 0; k < count; ++k) {
            Scalar row[inertial_parameters];
            inertial_row(screws[k], motion, row);
            std::copy_n(row, payload_columns, payload + payload_columns * k);
            const Vector3<Scalar> velocity =
                screws[k].linear + cross(screws[k].angular, Vector3<Scalar>::from(point));
            for (int i = 0; i < force_columns; ++i) {
                force[force_columns * k + i] = -dot(velocity, axes[i]);
            }
        }
    };
    for_each_body<Arm, Scalar>(chain, sizes, xi, visit);
}

} // namespace dfdyn
