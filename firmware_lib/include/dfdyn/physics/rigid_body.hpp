// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/features/cos_sin.hpp"
#include "dfdyn/physics/chain.hpp"

#include <algorithm>

namespace dfdyn {

/// Motion of a link in its own frame: rad/s, rad/s², m/s². `acceleration`: of the frame's origin, minus
/// gravity.
template <class Scalar>
struct LinkMotion {
    Vector3<Scalar> angular_velocity, angular_acceleration, acceleration;
};

namespace detail {

/// Returns the pose of a link's frame in the previous link's frame for a joint at `position`. Rodrigues'
/// rotation about the axis, row by row: only the last line depends on the position.
template <class Scalar, class Real>
LinkFrame<Scalar> link_frame(const ChainJoint<Real>& joint, const Scalar& position) noexcept {
    Scalar c(1);
    Scalar s(0);
    if (!joint.prismatic) {
        cos_sin_of(position, c, s);
    }
    const Scalar slide = joint.prismatic ? position : Scalar(0);
    const auto axis = Vector3<Real>::from(joint.axis);
    LinkFrame<Scalar> frame{{}, Vector3<Scalar>::from(joint.placement.translation)};
    Scalar* const origin[] = {&frame.origin.x, &frame.origin.y, &frame.origin.z};
    for (int i = 0; i < 3; ++i) {
        const auto row = Vector3<Real>::from(joint.placement.rotation + 3 * i);
        const Real component = dot(row, axis);
        const auto along = axis * component;
        frame.row[i] = Vector3<Scalar>::from(along) + Vector3<Scalar>::from(row - along) * c +
                       Vector3<Scalar>::from(cross(row, axis)) * s;
        *origin[i] += slide * component;
    }
    return frame;
}

/// Returns the motion of a link from the motion of the previous link and the joint's rate and acceleration.
template <class Scalar, class Real>
LinkMotion<Scalar> link_motion(const LinkMotion<Scalar>& previous, const LinkFrame<Scalar>& frame,
                               const ChainJoint<Real>& joint, const Scalar& velocity,
                               const Scalar& acceleration) noexcept {
    const auto& [angular_velocity, angular_acceleration, base_acceleration] = previous;
    const Vector3<Scalar> w = frame.inward(angular_velocity);
    const auto axis = Vector3<Scalar>::from(joint.axis);
    const Vector3<Scalar> rate = axis * velocity;
    const Vector3<Scalar> own = axis * acceleration;
    LinkMotion<Scalar> link{w, frame.inward(angular_acceleration),
                            frame.inward(base_acceleration + cross(angular_acceleration, frame.origin) +
                                         cross(angular_velocity, cross(angular_velocity, frame.origin)))};
    const Vector3<Scalar> turned = cross(w, rate);
    if (joint.prismatic) {
        link.acceleration = link.acceleration + turned + turned + own;
    } else {
        link.angular_velocity = w + rate;
        link.angular_acceleration = link.angular_acceleration + turned + own;
    }
    return link;
}

} // namespace detail

/// Traverses the chain and calls visit(body, motion, screws, count) for every body, base to tip. `screws`
/// contains those of the first `count` outputs, in the body's frame; the body does not contribute to the
/// other outputs. `xi` is (q, q̇, q̈) of each joint: element j of joint i at 3i + j; rad, m, s. O(n m).
template <class Arm, class Real, class Scalar, class Visit>
void for_each_body(const typename Arm::template Constants<Real>& chain, const typename Arm::Sizes& sizes,
                   const Scalar* xi, Visit visit) noexcept {
    const auto none = Vector3<Scalar>::zero();
    LinkMotion<Scalar> motion{none, none, none - Vector3<Scalar>::from(chain.gravity)};
    auto screws = Storage<Screw<Scalar>, Arm::outputs>::zeros(sizes.output_count);
    const ChainJoint<Real>* joints = chain.joint.data();
    int count = Arm::Output::begin(chain.output, joints, 0, screws.data());
    for (int i = 0; i < sizes.joint_count; ++i) {
        const LinkFrame<Scalar> frame = detail::link_frame(joints[i], xi[3 * i]);
        motion = detail::link_motion(motion, frame, joints[i], xi[3 * i + 1], xi[3 * i + 2]);
        for (int k = 0; k < count; ++k) {
            screws[k] = frame.inward(screws[k]);
        }
        count += Arm::Output::begin(chain.output, joints, i + 1, screws.data() + count);
        const int body = i - (sizes.joint_count - sizes.body_count);
        if (body >= 0) {
            visit(body, motion, screws.data(), count);
        }
    }
}

/// Writes the ten derivatives (`row`) of a screw's output with respect to a body's inertial parameters: screw
/// · wrench. The wrench of the body about its frame's origin is force = m a + A (mc), torque = (mc) × a + I α
/// + ω × I ω, with A = [α]× + [ω]×[ω]×.
template <class Scalar>
void inertial_row(const Screw<Scalar>& screw, const LinkMotion<Scalar>& motion, Scalar* row) noexcept {
    const auto& [w, alpha, a] = motion;
    const auto& [u, v] = screw;
    const Scalar turn = dot(v, w);
    const Scalar speed_square = dot(w, w);
    const Vector3<Scalar> moment = cross(v, alpha) + w * turn - v * speed_square + cross(a, u);
    const Vector3<Scalar> uw = cross(u, w);
    row[0] = dot(v, a);
    row[1] = moment.x;
    row[2] = moment.y;
    row[3] = moment.z;
    row[4] = u.x * alpha.x + uw.x * w.x;
    row[5] = u.x * alpha.y + u.y * alpha.x + uw.x * w.y + uw.y * w.x;
    row[6] = u.x * alpha.z + u.z * alpha.x + uw.x * w.z + uw.z * w.x;
    row[7] = u.y * alpha.y + uw.y * w.y;
    row[8] = u.y * alpha.z + u.z * alpha.y + uw.y * w.z + uw.z * w.y;
    row[9] = u.z * alpha.z + uw.z * w.z;
}

/// Returns the multiply-adds of the regressor for revolute joints; a prismatic joint needs no cosine and
/// sine. Terms: frame and motion per joint; change of frame per screw and joint that it passes; row per pair
/// of an output and a contributing body.
template <class Arm, class Scalar>
constexpr std::int64_t rigid_body_cost(const typename Arm::Sizes& sizes) noexcept {
    constexpr std::int64_t joint = cos_sin_cost<Scalar>(1) + 57 + 57;
    using Output = typename Arm::Output;
    return joint * sizes.joint_count + Output::begin_cost +
           24 * Output::carries(sizes.output_count, sizes.body_count, sizes.joint_count) +
           51 * Output::pairs(sizes.output_count, sizes.body_count);
}

/// Writes the rows ψ with ψ π = output (paper, Section III-A, eq. 3), where π contains the inertial
/// parameters of every body, base to tip, each in the order of `inertial_parameters`. Writes outputs ×
/// 10·bodies values, row-major, rows `stride` ≥ 10·bodies apart. O(n²): each output's screw is transformed
/// along the chain and multiplied with the wrench of each body, so that no wrench has to be transformed back.
///
/// `xi` is (q, q̇, q̈) of each joint: element j of joint i at 3i + j; rad, m, s. The scalar of the motion may
/// carry derivatives. The constants then have a plain scalar or the same one, and entries that are 0 in every
/// motion carry no derivatives. Arguments are not checked: values that are not finite give results that are
/// not finite.
template <class Arm, class Real, class Scalar>
void rigid_body_regressor(const typename Arm::template Constants<Real>& chain,
                          const typename Arm::Sizes& sizes, const Scalar* xi, Scalar* psi,
                          int stride) noexcept {
    const auto write = [&](int body, const LinkMotion<Scalar>& motion, const Screw<Scalar>* screws,
                           int count) {
        for (int k = 0; k < sizes.output_count; ++k) {
            Scalar* row = psi + k * stride + inertial_parameters * body;
            if (k < count) {
                inertial_row(screws[k], motion, row);
            } else {
                std::fill_n(row, inertial_parameters, Scalar(0));
            }
        }
    };
    for_each_body<Arm, Real>(chain, sizes, xi, write);
}

} // namespace dfdyn
