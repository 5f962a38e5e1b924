// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/catch.hpp"

#include <Eigen/Core>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>

namespace dfdyn::tests {

/// Returns the torques at the joints of a chain. `xi`: position, velocity and acceleration of each joint.
inline Eigen::VectorXd kdl_torques(const KDL::Chain& chain, const KDL::Vector& gravity,
                                   const Eigen::VectorXd& xi) {
    const unsigned n = chain.getNrOfJoints();
    REQUIRE(n == static_cast<unsigned>(xi.size() / 3));
    KDL::JntArray position(n);
    KDL::JntArray velocity(n);
    KDL::JntArray acceleration(n);
    KDL::JntArray torques(n);
    for (unsigned i = 0; i < n; ++i) {
        position(i) = xi[3 * i];
        velocity(i) = xi[3 * i + 1];
        acceleration(i) = xi[3 * i + 2];
    }
    KDL::ChainIdSolver_RNE solver(chain, gravity);
    REQUIRE(solver.CartToJnt(position, velocity, acceleration, KDL::Wrenches(chain.getNrOfSegments()),
                             torques) == 0);
    return torques.data;
}

} // namespace dfdyn::tests
