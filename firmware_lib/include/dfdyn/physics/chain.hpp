// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"
#include "dfdyn/physics/spatial.hpp"

#include <cstdint>

namespace dfdyn {

/// Pose of a frame in an outer frame: x_outer = rotation x_inner + translation.
template <class Scalar>
struct Placement {
    Scalar rotation[9];    ///< row-major, orthonormal
    Scalar translation[3]; ///< m
};

/// A joint of a serial chain. Its frame is also the frame of the link that it moves: from the pose
/// `placement`, the link rotates about `axis` (revolute) or slides along it (prismatic).
template <class Scalar>
struct ChainJoint {
    /// Pose of the link's frame in the previous link's frame, at joint position 0.
    Placement<Scalar> placement;
    Scalar axis[3]; ///< unit vector in the link's frame
    bool prismatic; ///< slides along `axis` (m) instead of rotating about it (rad)
};

/// Parameters per body, in the link's frame: mass, first moment m·c, and inertia about the origin of the
/// link's frame: m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz (kg, kg·m, kg·m²).
inline constexpr int inertial_parameters = 10;

/// The outputs of a chain are the generalised forces of its joints (N·m, N); every link contributes.
///
/// A kind of outputs defines a unique `identity`, the number of outputs, and the number of bodies that
/// contribute (the last `bodies` links). `begin` defines the link at which each output's screw begins. The
/// screw is the motion whose virtual power is that output.
struct JointTorques {
    static constexpr int identity = 1; ///< unique among the kinds of outputs
    /// Returns the number of outputs of an arm with `joints` joints.
    static constexpr int outputs(int joints) noexcept { return joints; }
    /// Returns the number of bodies that contribute.
    static constexpr int bodies(int joints) noexcept { return joints; }

    /// Torques need no constants.
    template <class Scalar>
    struct Constants {};

    /// Writes the screws of the outputs that begin at `link` (0: the base), in its frame; returns their
    /// number.
    template <class Real, class Scalar>
    static constexpr int begin(const Constants<Real>& /*output*/, const ChainJoint<Real>* joints, int link,
                               Screw<Scalar>* screws) noexcept {
        if (link == 0) {
            return 0;
        }
        const auto axis = Vector3<Scalar>::from(joints[link - 1].axis);
        const auto none = Vector3<Scalar>::zero();
        screws[0] = joints[link - 1].prismatic ? Screw<Scalar>{none, axis} : Screw<Scalar>{axis, none};
        return 1;
    }

    /// Returns the number of pairs of an output and a body that contributes to it.
    static constexpr std::int64_t pairs(int outputs, int /*bodies*/) noexcept {
        return std::int64_t{outputs} * (outputs + 1) / 2;
    }

    /// Returns the number of transforms of a screw from one link's frame to the next.
    static constexpr std::int64_t carries(int outputs, int /*bodies*/, int /*joints*/) noexcept {
        return std::int64_t{outputs} * (outputs - 1) / 2;
    }

    /// Multiply-adds of all calls of `begin`.
    static constexpr int begin_cost = 0;
};

/// The outputs are force (N) and torque (N·m, about the origin of the sensor frame) at a sensor within the
/// chain, in the sensor's frame. Only bodies beyond the sensor contribute: the last `body_count` links, the
/// first of them without its part on the base's side of the sensor. That is n - link + 1 bodies, or all n if
/// the sensor is mounted on the base.
template <int body_count>
struct WrenchAtSensor {
    static constexpr int identity = 2; ///< unique among the kinds of outputs
    /// Returns 6: three forces (N), three torques (N·m).
    static constexpr int outputs(int /*joints*/) noexcept { return 6; }
    /// Returns the number of bodies that contribute.
    static constexpr int bodies(int /*joints*/) noexcept { return body_count; }

    /// Place and sign of the sensor.
    template <class Scalar>
    struct Constants {
        std::int32_t link;        ///< link that carries the sensor: 0 the base, i the link that joint i moves
        Placement<Scalar> sensor; ///< pose of the sensor's frame in that link's frame
        /// +1: wrench that the base's side exerts on the tip's side; -1: the opposite (child to parent).
        Scalar sign;
    };

    /// Writes the unit motions along and about the sensor's axes.
    template <class Real, class Scalar>
    static constexpr int begin(const Constants<Real>& output, const ChainJoint<Real>* /*joints*/, int link,
                               Screw<Scalar>* screws) noexcept {
        if (link != output.link) {
            return 0;
        }
        const Real* rotation = output.sensor.rotation;
        const auto origin = Vector3<Real>::from(output.sensor.translation);
        for (int i = 0; i < 3; ++i) {
            const Real column[] = {rotation[i], rotation[3 + i], rotation[6 + i]};
            const auto axis = Vector3<Real>::from(column) * output.sign;
            const auto lever = cross(origin, axis);
            screws[i] = {Vector3<Scalar>::zero(), Vector3<Scalar>::from(axis)};
            screws[3 + i] = {Vector3<Scalar>::from(axis), Vector3<Scalar>::from(lever)};
        }
        return 6;
    }

    /// Returns the number of pairs of an output and a body that contributes to it.
    static constexpr std::int64_t pairs(int outputs, int bodies) noexcept {
        return std::int64_t{outputs} * bodies;
    }

    /// Returns an upper bound of the number of transforms of a screw from one link's frame to the next: if
    /// every link contributes, the sensor may be on the first link instead of the base.
    static constexpr std::int64_t carries(int outputs, int bodies, int joints) noexcept {
        return std::int64_t{outputs} * (bodies == joints ? bodies : bodies - 1);
    }

    /// Multiply-adds of all calls of `begin`.
    static constexpr int begin_cost = 27;
};

/// A serial chain of n joints whose geometry is compiled in. The inertial parameters of its bodies are
/// learned.
template <int n, class OutputType = JointTorques>
struct Chain {
    using Output = OutputType;                             ///< `JointTorques` or `WrenchAtSensor`
    static constexpr int joints = n;                       ///< joints, base to tip
    static constexpr int outputs = OutputType::outputs(n); ///< m
    static constexpr int bodies = OutputType::bodies(n);   ///< links that contribute, the last ones
    static constexpr int parameters = product(inertial_parameters, bodies); ///< ten per body
    static_assert(n == dynamic || bodies <= n, "more bodies than links");

    /// Empty for a firmware model, where every size is a template argument.
    struct Sizes {
        [[no_unique_address]] Extent<joints> joint_count{};   ///< n
        [[no_unique_address]] Extent<outputs> output_count{}; ///< m
        [[no_unique_address]] Extent<bodies> body_count{};    ///< links that contribute
    };

    /// Geometry of the arm.
    template <class Scalar>
    struct Constants {
        Storage<ChainJoint<Scalar>, n> joint; ///< base to tip
        Scalar gravity[3];                    ///< m/s², in the base link's frame
        [[no_unique_address]] typename OutputType::template Constants<Scalar>
            output; ///< of the kind of outputs
    };
};

} // namespace dfdyn
