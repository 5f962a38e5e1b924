// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/core/storage.hpp"
#include "dfdyn/features/cos_sin.hpp"

#include <cmath>
#include <concepts>
#include <cstdint>

namespace dfdyn {

/// A named effect adds columns to the physics. Each column acts on one output and is known up to a factor,
/// which is learned. An effect defines
///  - `identity`: unique among the effects, 1000 or more for a user's own; part of a snapshot;
///  - `columns`: their number; `column_cost<Scalar>`: maximum multiply-adds of one;
///  - `at_joint`: true if the columns act on joints, so that the outputs must be joint torques;
///  - `Constants`: `row` gives the output (0: the first) that each column acts on; the effect may add more;
///  - `value(constants, column, xi)`: the entry of a column in that row, from (q, q̇, q̈), element j of joint
///    i at 3i + j. The unit is N·m (N) of actuator torque (force) per unit of the parameter.
///
/// The scalar of the motion may carry derivatives.
template <class E>
concept PhysicsEffect = requires(const typename E::template Constants<float>& constants, int column,
                                 const float* xi) {
    { E::identity } -> std::convertible_to<int>;
    { E::columns } -> std::convertible_to<int>;
    { E::template column_cost<float> } -> std::convertible_to<std::int64_t>;
    { E::at_joint } -> std::convertible_to<bool>;
    { constants.row[column] } -> std::convertible_to<std::int32_t>;
    { constants.row.size() } -> std::convertible_to<int>;
    { E::value(constants, column, xi) }
    noexcept->std::same_as<float>;
};

namespace detail {

/// An effect whose columns equal one element of their joint's motion (0: q, 1: q̇, 2: q̈). The template
/// argument `Effect` makes the constants of different effects different types.
template <template <int> class Effect, int count, int element>
struct MotionColumns {
    static constexpr int columns = count; ///< each acts on one output
    /// Maximum multiply-adds of one column.
    template <class>
    static constexpr std::int64_t column_cost = 0;
    static constexpr bool at_joint = true; ///< the outputs must be joint torques

    /// Place and shape of each column.
    template <class Scalar>
    struct Constants {
        Storage<std::int32_t, count> row; ///< output of each column, from 0
    };

    /// Returns the entry of a column for the motion `xi` (q, q̇, q̈ of joint i at 3i).
    template <class Real, class Scalar>
    static Scalar value(const Constants<Real>& constants, int column, const Scalar* xi) noexcept {
        return xi[3 * constants.row[column] + element];
    }
};

} // namespace detail

/// `viscous_friction`: q̇. Unit of the parameter: N·m·s/rad.
template <int count>
struct ViscousFriction : detail::MotionColumns<ViscousFriction, count, 1> {
    static constexpr int identity = 1; ///< in a snapshot
};

/// `coulomb_friction`: tanh(q̇ / v), a smooth sign. Unit of the parameter: N·m.
template <int count>
struct CoulombFriction {
    static constexpr int identity = 2;    ///< in a snapshot
    static constexpr int columns = count; ///< each acts on one output
    /// Maximum multiply-adds of one column.
    template <class>
    static constexpr std::int64_t column_cost = function_cost + 1;
    static constexpr bool at_joint = true; ///< the outputs must be joint torques

    /// Place and shape of each column.
    template <class Scalar>
    struct Constants {
        Storage<std::int32_t, count> row;     ///< output of each column, from 0
        Storage<Scalar, count> sign_velocity; ///< v > 0 (rad/s): 3 v gives 99.5 % of the sign
    };

    /// Returns the entry of a column for the motion `xi` (q, q̇, q̈ of joint i at 3i).
    template <class Real, class Scalar>
    static Scalar value(const Constants<Real>& constants, int column, const Scalar* xi) noexcept {
        using std::tanh;
        return tanh(Scalar(xi[3 * constants.row[column] + 1] / constants.sign_velocity[column]));
    }
};

/// `stribeck_friction`, in addition to Coulomb friction: tanh(q̇ / v) exp(-(q̇ / v_s)²). The parameter is
/// static minus Coulomb friction (N·m).
template <int count>
struct StribeckFriction {
    static constexpr int identity = 3;    ///< in a snapshot
    static constexpr int columns = count; ///< each acts on one output
    /// Maximum multiply-adds of one column.
    template <class>
    static constexpr std::int64_t column_cost = 2 * function_cost + 4;
    static constexpr bool at_joint = true; ///< the outputs must be joint torques
    /// exp(-40) is negligible; beyond 87 the result in float would be denormal.
    static constexpr int faded = 40;

    /// Place and shape of each column.
    template <class Scalar>
    struct Constants {
        Storage<std::int32_t, count> row;         ///< output of each column, from 0
        Storage<Scalar, count> sign_velocity;     ///< v > 0 (rad/s), as for Coulomb friction
        Storage<Scalar, count> stribeck_velocity; ///< v_s > 0 (rad/s), above v
    };

    /// Returns the entry of a column for the motion `xi` (q, q̇, q̈ of joint i at 3i).
    template <class Real, class Scalar>
    static Scalar value(const Constants<Real>& constants, int column, const Scalar* xi) noexcept {
        using std::exp;
        using std::tanh;
        const Scalar& velocity = xi[3 * constants.row[column] + 1];
        const Scalar ratio = velocity / constants.stribeck_velocity[column];
        const Scalar square = ratio * ratio;
        if (square > faded) {
            return Scalar(0);
        }
        const Scalar sign = tanh(Scalar(velocity / constants.sign_velocity[column]));
        const Scalar fading = exp(Scalar(-square));
        return sign * fading;
    }
};

/// `rotor_inertia`: q̈. The parameter is the inertia reflected to the joint (kg·m²).
template <int count>
struct RotorInertia : detail::MotionColumns<RotorInertia, count, 2> {
    static constexpr int identity = 4; ///< in a snapshot
};

/// `joint_spring`: q. The parameter is the stiffness (N·m/rad). Its rest position is part of the row's
/// offset.
template <int count>
struct JointSpring : detail::MotionColumns<JointSpring, count, 0> {
    static constexpr int identity = 5; ///< in a snapshot
};

/// `torque_ripple`: sin(c q + phase). Two columns with phases 0 and pi/2 form a wave of any phase. Unit of
/// the parameters: N·m.
template <int count>
struct TorqueRipple {
    static constexpr int identity = 6;    ///< in a snapshot
    static constexpr int columns = count; ///< each acts on one output
    /// Maximum multiply-adds of one column.
    template <class Scalar>
    static constexpr std::int64_t column_cost = cos_sin_cost<Scalar>(1) + 1;
    static constexpr bool at_joint = true; ///< the outputs must be joint torques

    /// Place and shape of each column.
    template <class Scalar>
    struct Constants {
        Storage<std::int32_t, count> row; ///< output of each column, from 0
        Storage<Scalar, count>
            cycles_per_rev; ///< c > 0, c |q| ≤ 8000; in float the angle is accurate to 1e-4 rad up to c = 200
        Storage<Scalar, count> phase; ///< rad
    };

    /// Returns the entry of a column for the motion `xi` (q, q̇, q̈ of joint i at 3i).
    template <class Real, class Scalar>
    static Scalar value(const Constants<Real>& constants, int column, const Scalar* xi) noexcept {
        const Scalar angle = xi[3 * constants.row[column]] * constants.cycles_per_rev[column];
        Scalar cosine(0);
        Scalar sine(0);
        cos_sin_of(Scalar(angle + constants.phase[column]), cosine, sine);
        return sine;
    }
};

/// `torque_offset` or `ft_bias`: 1. The parameter is added to the output (N·m, N).
template <int count>
struct OutputOffset {
    static constexpr int identity = 7;    ///< in a snapshot
    static constexpr int columns = count; ///< each acts on one output
    /// Maximum multiply-adds of one column.
    template <class>
    static constexpr std::int64_t column_cost = 0;
    static constexpr bool at_joint = false; ///< for joint torques and wrenches

    /// Place and shape of each column.
    template <class Scalar>
    struct Constants {
        Storage<std::int32_t, count> row; ///< output of each column, from 0
    };

    /// Returns the entry of a column for the motion `xi` (q, q̇, q̈ of joint i at 3i).
    template <class Real, class Scalar>
    static Scalar value(const Constants<Real>& /*constants*/, int /*column*/, const Scalar* /*xi*/) noexcept {
        return Scalar(1);
    }
};

} // namespace dfdyn
