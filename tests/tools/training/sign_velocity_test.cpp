// SPDX-License-Identifier: Apache-2.0
#include "tools/training/sign_velocity.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/training/physics/physics_columns.hpp"
#include "tools/training/physics/robot_regressor.hpp"

namespace sign_velocity_test {

using namespace dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST_CASE("the sign velocity of the recording's friction is found") {
    const double truth = GENERATE(0.1, 0.02, 0.01);
    CAPTURE(truth, dfdyn::tests::seed());
    const ChainModel chain = chain_model(dfdyn::tests::planar_arm(9.81), OutputKind::joint_torque);
    const auto regressor_at = [&chain](double sign_velocity) {
        return robot_regressor(chain, effect_models({"coulomb_friction"}, chain, sign_velocity), {1, 1});
    };
    NormalSource random(dfdyn::tests::seed());
    TrainingData data = dfdyn::tests::arm_data(1500, 2, 2, random);
    const auto regressor = regressor_at(truth);
    VectorXd parameters = random.matrix(regressor->columns(), 1);
    parameters.tail(2) << 20, 30;
    const MatrixXd columns = all_columns(*regressor, {data.positions, data.velocities, data.accelerations});
    for (Index output = 0; output < 2; ++output) {
        data.outputs.col(output) =
            columns.middleCols(output * parameters.size(), parameters.size()) * parameters +
            0.1 * random.matrix(1500, 1);
    }
    TrainingOptions options;
    options.lags = 6;
    CHECK(most_likely_sign_velocity(data, options, regressor_at) == truth);
}

} // namespace sign_velocity_test
