// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/physics/rigid_body.hpp"
#include "tests/support/random_robot.hpp"

namespace dfdyn::tests {

using Regressor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// ψ of an arm whose sizes are known at run time.
template <class Arm>
Regressor regressor(const typename Arm::template Constants<double>& chain, const typename Arm::Sizes& sizes,
                    const Eigen::VectorXd& xi) {
    const int columns = inertial_parameters * sizes.body_count;
    Regressor psi = Regressor::Constant(sizes.output_count, columns, std::nan(""));
    rigid_body_regressor<Arm>(chain, sizes, xi.data(), psi.data(), columns);
    return psi;
}

/// All links' parameters, one after the other.
inline Eigen::VectorXd all_parameters(const tools::Robot& robot) {
    Eigen::VectorXd parameters(inertial_parameters * robot.joints.size());
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        parameters.segment<inertial_parameters>(static_cast<Eigen::Index>(inertial_parameters * i)) =
            robot.joints[i].inertia;
    }
    return parameters;
}

} // namespace dfdyn::tests
