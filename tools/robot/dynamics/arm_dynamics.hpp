// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"
#include "tools/robot/dynamics/spatial.hpp"

#include <vector>

namespace dfdyn::tools {

/// Rigid-body dynamics of a chain in double precision, without a regressor: recursive Newton-Euler and
/// composite rigid bodies with spatial vectors. Rotors have inertia about their own joint only (their
/// gyroscopic moments are neglected, as usual for geared drives). All vectors have one entry per joint;
/// positions in rad or m. No heap. Cost: O(n), the mass matrix O(n²).
class ArmDynamics {
  public:
    /// `rotor_inertia`: kg·m² (prismatic: kg), at the joint's side of the gear. Throws InputError if the
    /// chain is longer than the simulation supports, has no joint, or has a body with negative mass.
    ArmDynamics(Robot robot, JointVector rotor_inertia);

    int joint_count() const noexcept { return static_cast<int>(robot_.joints.size()); }
    const Robot& robot() const noexcept { return robot_; }

    /// Position-dependent quantities, computed once per position and used by all functions below.
    struct Configuration {
        std::vector<SpatialMotion> axis;      ///< per joint
        std::vector<SpatialInertia> inertia;  ///< per link
        std::vector<Eigen::Isometry3d> place; ///< per link, in the base's frame
    };

    /// Computes `configuration` and reuses its memory.
    void configure(const JointVector& position, Configuration& configuration) const;

    /// Returns the torques (prismatic: forces) for this motion under gravity, including rotors.
    JointVector inverse(const Configuration& configuration, const JointVector& velocity,
                        const JointVector& acceleration) const;

    /// Returns the mass matrix, symmetric and positive definite, including rotors.
    JointMatrix mass_matrix(const Configuration& configuration) const;

    /// Returns the acceleration for these torques.
    JointVector forward(const Configuration& configuration, const JointVector& velocity,
                        const JointVector& torque) const;

    /// Returns the wrench that an ideal force/torque sensor of the robot would measure: between the parts on
    /// its two sides, in its frame, about its origin, in its own measuring direction. The robot must have a
    /// sensor.
    Wrench wrench(const Configuration& configuration, const JointVector& velocity,
                  const JointVector& acceleration) const;

    /// Returns the contribution to that wrench of a force (N) on a point (m) beyond the sensor; both in the
    /// base's frame.
    Wrench wrench_of_force(const Configuration& configuration, const Eigen::Vector3d& point,
                           const Eigen::Vector3d& force) const;

    /// Returns kinetic (including rotors) plus potential energy, J; the latter is zero at the base's origin.
    double energy(const Configuration& configuration, const JointVector& velocity) const;

    /// Returns the origin of the tip frame in the base's frame, m.
    Eigen::Vector3d tip(const Configuration& configuration) const;
    PointJacobian tip_jacobian(const Configuration& configuration) const;
    /// Returns the Jacobian of a point (m, in the base's frame) of the link that joint `link`, from 0, moves.
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
    /// `beyond`: the force of the part on the sensor's base side on the other part.
    Wrench at_sensor(const SpatialForce& beyond, const Eigen::Isometry3d& sensor_link) const;

    Robot robot_;
    JointVector rotor_inertia_;
};

} // namespace dfdyn::tools
