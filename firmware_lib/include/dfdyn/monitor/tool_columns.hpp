// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/output_block.hpp"
#include "dfdyn/physics/rigid_body.hpp"

#include <algorithm>

namespace dfdyn {

/// Computes partial derivatives of the outputs (N·m, N):
/// - `payload`, m × 4: with respect to mass and first moment about `point` of a body fixed to the last link;
/// - `force`, m × 3: with respect to a force on that link at `point`, in the base frame.
///
/// `point`: m, in the frame of the last link. `xi`: 3 n, position, velocity and acceleration of each joint,
/// as for `for_each_body`. `screws`: workspace of m. Cost: at most `tool_columns_cost` multiply-adds.
template <class Arm, class Scalar>
void tool_columns(const typename Arm::template Constants<Scalar>& chain, const typename Arm::Sizes& sizes,
                  const Scalar* xi, const Scalar* point, Screw<Scalar>* screws, Scalar* payload,
                  Scalar* force) noexcept {
    const auto none = Vector3<Scalar>::zero();
    LinkMotion<Scalar> motion{none, none, none - Vector3<Scalar>::from(chain.gravity)};
    Vector3<Scalar> axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; // axes of the base in the link's frame
    const ChainJoint<Scalar>* joints = chain.joint.data();
    int count = Arm::Output::begin(chain.output, joints, 0, screws);
    for (int i = 0; i < sizes.joint_count; ++i) {
        const LinkFrame<Scalar> frame = detail::link_frame(joints[i], xi[3 * i]);
        motion = detail::link_motion(motion, frame, joints[i], xi[3 * i + 1], xi[3 * i + 2]);
        for (Vector3<Scalar>& axis : axes) {
            axis = frame.inward(axis);
        }
        for (int k = 0; k < count; ++k) {
            screws[k] = frame.inward(screws[k]);
        }
        count += Arm::Output::begin(chain.output, joints, i + 1, screws + count);
    }
    const auto tip = Vector3<Scalar>::from(point);
    for (int k = 0; k < count; ++k) {
        Scalar row[inertial_parameters];
        inertial_row(screws[k], motion, row);
        row[0] += point[0] * row[1] + point[1] * row[2] + point[2] * row[3];
        std::copy_n(row, payload_columns, payload + payload_columns * k);
        const Vector3<Scalar> velocity = screws[k].linear + cross(screws[k].angular, tip);
        for (int i = 0; i < force_columns; ++i) {
            force[force_columns * k + i] = -dot(velocity, axes[i]);
        }
    }
}

/// Returns an upper bound of the cost: frame, motion and axes for each joint, a change of frame for each pair
/// of output and joint, and the rows for each output.
constexpr std::int64_t tool_columns_cost(int joints, int outputs) noexcept {
    constexpr int joint = 2 * function_cost + 57 + 57 + 27;
    return std::int64_t{joint} * joints + std::int64_t{24} * outputs * joints + std::int64_t{75} * outputs +
           30;
}

} // namespace dfdyn
