// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/output_block.hpp"
#include "dfdyn/physics/rigid_body.hpp"

namespace dfdyn {

/// Derivatives of the outputs (N·m, N) by a body fixed to the last link, mass and first moment about `point`
/// (m, in the link's frame), m × 4, and by a force on the link at `point`, m × 3. `xi` as of `for_each_body`.
/// At most `tool_columns_cost` multiply-adds.
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
            row[0] += point[0] * row[1] + point[1] * row[2] + point[2] * row[3];
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

constexpr std::int64_t tool_columns_cost(int joints, int outputs) noexcept {
    return std::int64_t{joints} * 400 + std::int64_t{outputs} * 150;
}

} // namespace dfdyn
