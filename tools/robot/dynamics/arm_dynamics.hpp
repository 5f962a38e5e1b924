// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"
#include "tools/robot/dynamics/spatial.hpp"

#include <vector>

namespace dfdyn::tools {

/// Rigid-body dynamics of a chain, in double precision, without a regressor: recursive Newton-Euler and
/// composite rigid bodies over spatial vectors. Rotors count as inertia about their own joint only (their
/// gyroscopic moments are neglected, as usual for geared drives). All vectors have one entry per joint;
/// positions in rad or m. No heap. Cost: O(n), the mass matrix O(n²).
class ArmDynamics {
  public:
    /// `rotor_inertia`: kg·m² (prismatic: kg), seen at the joint. Throws InputError when the chain is longer
    /// than the simulation holds, has no joint, or has a body with negative mass.
    ArmDynamics(Robot robot, JointVector rotor_inertia);

    int joint_count() const noexcept { return static_cast<int>(robot_.joints.size()); }
    const Robot& robot() const noexcept { return robot_; }

    /// What depends on the position only; made once per position and used by everything below.
    struct Configuration {
        std::vector<SpatialMotion> axis;      ///< per joint
        std::vector<SpatialInertia> inertia;  ///< per link
        std::vector<Eigen::Isometry3d> place; ///< per link, in the base's frame
    };

    /// Fills `configuration`, whose memory is used again.
    void configure(const JointVector& position, Configuration& configuration) const;

    /// Torques (prismatic: forces) that cause this motion under gravity, rotors included.
    JointVector inverse(const Configuration& configuration, const JointVector& velocity,
                        const JointVector& acceleration) const;

    /// Symmetric, positive definite; rotors included.
    JointMatrix mass_matrix(const Configuration& configuration) const;

    /// The acceleration that these torques cause.
    JointVector forward(const Configuration& configuration, const JointVector& velocity,
                        const JointVector& torque) const;

    /// What the robot's force/torque sensor would measure if it were perfect: the interaction of the parts on
    /// its two sides, in its frame, about its origin, in its own measuring direction. The robot must have
    /// one.
    Wrench wrench(const Configuration& configuration, const JointVector& velocity,
                  const JointVector& acceleration) const;

    /// What a force (N) on a point (m) of a part beyond the sensor adds to that; both in the base's frame.
    Wrench wrench_of_force(const Configuration& configuration, const Eigen::Vector3d& point,
                           const Eigen::Vector3d& force) const;

    /// Kinetic (rotors included) plus potential energy; the latter is zero at the base's origin. J.
    double energy(const Configuration& configuration, const JointVector& velocity) const;

    /// Of the tip frame's origin, in the base's frame, m.
    Eigen::Vector3d tip(const Configuration& configuration) const;
    PointJacobian tip_jacobian(const Configuration& configuration) const;
    /// Of a point (m, in the base's frame) of the link that joint `link`, from 0, moves.
    PointJacobian point_jacobian(const Configuration& configuration, Eigen::Index link,
                                 const Eigen::Vector3d& point) const;

  private:
    struct LinkMotion {
        SpatialMotion velocity, acceleration;
    };

    LinkMotion step(const Configuration& configuration, std::size_t joint, const LinkMotion& previous,
                    double velocity, double acceleration) const;
    SpatialForce net_force(const SpatialInertia& inertia, const LinkMotion& motion) const;
    LinkMotion base_motion() const;
    /// `beyond`: the force that the part on the sensor's base side exerts on the other.
    Wrench at_sensor(const SpatialForce& beyond, const Eigen::Isometry3d& sensor_link) const;

    Robot robot_;
    JointVector rotor_inertia_;
};

} // namespace dfdyn::tools
