// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

namespace dfdyn {

/// A vector in three dimensions. The scalar may be any arithmetic type, including one that carries
/// derivatives.
template <class Scalar>
struct Vector3 {
    Scalar x, y, z;

    static constexpr Vector3 zero() noexcept { return {Scalar(0), Scalar(0), Scalar(0)}; }

    /// Converts three numbers of this scalar or of a plainer one.
    template <class Real>
    static constexpr Vector3 from(const Real* values) noexcept {
        return {Scalar(values[0]), Scalar(values[1]), Scalar(values[2])};
    }
    template <class Real>
    static constexpr Vector3 from(const Vector3<Real>& plain) noexcept {
        return {Scalar(plain.x), Scalar(plain.y), Scalar(plain.z)};
    }

    friend constexpr Vector3 operator+(const Vector3& a, const Vector3& b) noexcept {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    friend constexpr Vector3 operator-(const Vector3& a, const Vector3& b) noexcept {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
    template <class Factor>
    friend constexpr Vector3 operator*(const Vector3& a, const Factor& factor) noexcept {
        return {a.x * factor, a.y * factor, a.z * factor};
    }
    friend constexpr Vector3 cross(const Vector3& a, const Vector3& b) noexcept {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
    friend constexpr Scalar dot(const Vector3& a, const Vector3& b) noexcept {
        return a.x * b.x + a.y * b.y + a.z * b.z;
    }
};

/// A unit motion: angular velocity of a frame and velocity of its origin. Its product with a wrench about
/// that origin is the component of the wrench along the motion (its virtual power).
template <class Scalar>
struct Screw {
    Vector3<Scalar> angular, linear;
};

/// Pose of a link's frame in an outer frame; x_outer = (row_i · x_inner)_i + origin.
template <class Scalar>
struct LinkFrame {
    Vector3<Scalar> row[3];
    Vector3<Scalar> origin;

    /// Expresses a vector of the outer frame in this frame: 9 multiply-adds.
    [[nodiscard]] constexpr Vector3<Scalar> inward(const Vector3<Scalar>& outer) const noexcept {
        return row[0] * outer.x + row[1] * outer.y + row[2] * outer.z;
    }

    /// Expresses a motion of the outer frame in this frame: 24 multiply-adds.
    [[nodiscard]] constexpr Screw<Scalar> inward(const Screw<Scalar>& outer) const noexcept {
        return {inward(outer.angular), inward(outer.linear + cross(outer.angular, origin))};
    }
};

} // namespace dfdyn
