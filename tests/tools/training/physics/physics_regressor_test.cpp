// SPDX-License-Identifier: Apache-2.0
#include "tools/training/physics/physics_regressor.hpp"

#include "dfdyn/dfdyn.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/training/numerics.hpp"

namespace physics_regressor_test {

namespace tools = dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using Arm = dfdyn::Chain<dfdyn::dynamic>;
using Map = dfdyn::Physics<dfdyn::StandardMeasured, dfdyn::dynamic, dfdyn::CoulombFriction<dfdyn::dynamic>>;
using RigidBody = tools::PhysicsRegressor<Map, Arm>;

/// Regressor with all columns of a random robot and with Coulomb friction at its second joint.
RigidBody regressor_of(std::mt19937_64& engine, int joints) {
    RigidBody::Constants constants{};
    constants.chain = dfdyn::tests::chain_of<Arm>(dfdyn::tests::random_robot(engine, joints));
    const int columns = dfdyn::inertial_parameters * joints + 1;
    constants.selected = decltype(constants.selected)::zeros({columns});
    constants.column_scale = decltype(constants.column_scale)::zeros({columns});
    constants.output_gain = decltype(constants.output_gain)::zeros({joints});
    for (int c = 0; c < columns; ++c) {
        constants.selected[c] = c;
        constants.column_scale[c] = 1;
    }
    std::fill(constants.output_gain.begin(), constants.output_gain.end(), 1.0);
    auto& friction =
        static_cast<dfdyn::CoulombFriction<dfdyn::dynamic>::Constants<double>&>(constants.effects);
    friction.row = decltype(friction.row)::zeros({1});
    friction.row[0] = 1;
    friction.sign_velocity = decltype(friction.sign_velocity)::zeros({1});
    friction.sign_velocity[0] = 0.5;
    return {constants, RigidBody::Sizes{{joints}, {joints}, {joints}, {}, {columns}}};
}

tools::MotionState state_of(const VectorXd& xi) {
    const Index joints = xi.size() / 3;
    return {xi.head(joints), xi.segment(joints, joints), xi.tail(joints)};
}

TEST_CASE("training uses the physics of the firmware") {
    DFDYN_SEEDED_ENGINE(engine);
    const RigidBody regressor = regressor_of(engine, 3);
    const VectorXd xi = dfdyn::tests::random_motion(engine, 3);
    MatrixXd values(regressor.outputs(), regressor.columns());
    regressor.evaluate(state_of(xi), values);
    CHECK(values.rows() == 3);
    CHECK(values.cols() == 31);
    CHECK(values(1, 30) == Approx(std::tanh(xi[4] / 0.5)));
    CHECK(values(0, 30) == 0);
    CHECK(values.topLeftCorner(1, 30).cwiseAbs().maxCoeff() > 0);
    CHECK(values.block(2, 0, 1, 10).isZero()); // the first link does not load the last joint
}

TEST_CASE("the pull back of the regressor equals finite differences") {
    const int joints = GENERATE(2, 3, 6); // one pass of dual numbers, and several
    DFDYN_SEEDED_ENGINE(engine);
    const RigidBody regressor = regressor_of(engine, joints);
    const VectorXd xi = dfdyn::tests::random_motion(engine, joints);
    const MatrixXd weights = MatrixXd::NullaryExpr(regressor.outputs(), regressor.columns(),
                                                   [&] { return dfdyn::tests::uniform(engine, -1, 1); });
    const auto sum = [&](const VectorXd& moving) {
        VectorXd at = xi;
        at.tail(2 * joints) = moving;
        MatrixXd values(regressor.outputs(), regressor.columns());
        regressor.evaluate(state_of(at), values);
        return values.cwiseProduct(weights).sum();
    };
    const tools::RegressorGradient found = regressor.pull_back(state_of(xi), weights);
    VectorXd stacked(2 * joints);
    stacked << found.velocity, found.acceleration;
    CHECK(dfdyn::tests::relative_error(stacked, dfdyn::tests::differences(sum, xi.tail(2 * joints))) < 1e-6);
}

} // namespace physics_regressor_test
