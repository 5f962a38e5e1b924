// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/training/start/robot_prior.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tests/tools/training/synthetic_physics.hpp"
#include "tools/model/structure.hpp"
#include "tools/training/train.hpp"

namespace robot_prior_test {

namespace tools = dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index columns = 6;

/// A regressor whose last column is `factor` times its second.
class WithRepeatedColumn final : public tools::Regressor {
  public:
    WithRepeatedColumn(const tools::Regressor& exact, double factor) : exact_(exact), factor_(factor) {}

    Index outputs() const override { return exact_.outputs(); }
    Index columns() const override { return exact_.columns() + 1; }

    void evaluate(const tools::MotionState& state, MatrixXd& values) const override {
        MatrixXd exact(outputs(), exact_.columns());
        exact_.evaluate(state, exact);
        values << exact, factor_ * exact.col(1);
    }

    tools::RegressorGradient pull_back(const tools::MotionState& state,
                                       const MatrixXd& gradient) const override {
        MatrixXd exact = gradient.leftCols(exact_.columns());
        exact.col(1) += factor_ * gradient.col(exact_.columns());
        return exact_.pull_back(state, exact);
    }

  private:
    const tools::Regressor& exact_;
    double factor_;
};

/// A recording whose physics has a repeated column three times as large, and the robot's prior.
struct Arm {
    tools::NormalSource random{dfdyn::tests::seed()};
    tools::TrainingData data = dfdyn::tests::arm_data(500, 3, 2, random);
    dfdyn::tests::SyntheticRegressor exact{3, 2, columns, random};
    WithRepeatedColumn regressor{exact, 3};
    tools::TrainingOptions options;

    Arm() {
        options.model = &tools::structures::P;
        options.input = tools::InputKind::STD;
        options.lags = 5;
        options.likelihood_rows = 100;
        options.starts = 1;
        options.physics.regressor = &regressor;
        options.physics.nominal = VectorXd{{1, 2, 3, 4, 5, 6, 7}};
        options.physics.nominal_deviation = VectorXd{{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}};
    }
};

TEST_CASE("the prior of a column that was left out is added to the columns that replace it") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    const Arm arm;
    const tools::TrainingSetup setup(arm.data, arm.options);
    const VectorXd scale{{1, 2, 0.5, 1, 4, 1}};
    const tools::ParameterPrior prior = tools::robot_prior(setup, {{0, 1, 2, 3, 4, 5}, scale}, {});
    const VectorXd mean = VectorXd{{1, 2 + 3 * 7, 3, 4, 5, 6}}.cwiseQuotient(scale);
    CHECK((prior.mean - mean).norm() < 1e-6 * mean.norm());
    VectorXd deviation{{0.1, 0, 0.3, 0.4, 0.5, 0.6}};
    deviation[1] = std::hypot(0.2, 3 * 0.7);
    const double samples = tools::residual_correlation_s / arm.data.sample_period_s;
    REQUIRE(samples > 1);
    CHECK(tools::parameter_variance_factor(setup) == Approx(samples));
    const MatrixXd covariance = samples * tools::inverse_matrix(prior.information);
    const MatrixXd expected = deviation.cwiseQuotient(scale).cwiseAbs2().asDiagonal();
    CHECK((covariance - expected).norm() < 1e-6 * expected.norm());
}

TEST_CASE("the spacing of lags does not change the number of samples that count as one") {
    Arm arm;
    const double dense = tools::parameter_variance_factor({arm.data, arm.options});
    arm.data.sample_period_s *= 3; // like spaced_data(), which contains the rows of all phases
    arm.options.every = 3;
    CHECK(tools::parameter_variance_factor({arm.data, arm.options}) == Approx(dense));
}

TEST_CASE("a parameter follows the recording if that determines it and the robot's prior otherwise") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    Arm arm;
    const VectorXd truth{{2, -1, 3, 1.5, -2, 1}};
    const MatrixXd psi =
        tools::all_columns(arm.exact, {arm.data.positions, arm.data.velocities, arm.data.accelerations});
    for (Index k = 0; k < 2; ++k) {
        arm.data.outputs.col(k) =
            psi.middleCols(columns * k, columns) * truth + 0.05 * arm.random.matrix(500, 1);
    }
    arm.options.physics.nominal = VectorXd::Constant(7, 10);
    const auto parameters = [&arm](double deviation) {
        arm.options.physics.nominal_deviation = VectorXd::Constant(7, deviation);
        const tools::TrainedPhysics physics = *tools::train(arm.data, arm.options).physics;
        VectorXd result = VectorXd::Zero(7);
        result(physics.columns) = physics.column_scale.cwiseProduct(physics.start.parameters);
        result[1] += 3 * result[6]; // for either choice of column
        return VectorXd(result.head(columns));
    };
    CHECK((parameters(1e4) - truth).norm() < 0.1);
    const VectorXd robot{{10, 40, 10, 10, 10, 10}};
    CHECK((parameters(1e-6) - robot).norm() < 0.1);
    arm.options.shrinkage = false; // the estimator of the paper
    CHECK((parameters(1e-6) - truth).norm() < 0.1);
}

} // namespace robot_prior_test
