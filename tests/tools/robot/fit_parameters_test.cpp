// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/identification/fit_parameters.hpp"
#include "tools/robot/identification/log_cholesky.hpp"
#include "tools/robot/regressor.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/robot/arms.hpp"

#include <limits>

namespace tools = dfdyn::tools;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using tools::OutputKind;

namespace {

/// Measurements of an arm whose parameters differ from the nominal ones.
struct Experiment {
    tools::FitData data;
    VectorXd truth;
    tools::BaseParameters base;
};

Experiment experiment(const tools::Robot& robot, OutputKind outputs, Eigen::Index rows, double noise,
                      std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    Experiment result;
    result.data.nominal = tools::nominal_parameters(robot, outputs);
    result.truth = result.data.nominal;
    for (Eigen::Index first = 0; first < result.truth.size(); first += 10) {
        result.truth.segment<10>(first) += 0.1 * dfdyn::tests::random_body(engine).parameters();
    }
    const auto regressor = [&](Eigen::Index states, std::uint64_t seed) {
        return tools::stacked_regressor(robot, outputs, tools::random_motion(robot, states, seed));
    };
    result.data.regressor = regressor(rows, 5);
    result.base = tools::find_base_parameters(regressor(300, 1));
    const Eigen::Index count = result.data.regressor.rows() / rows;
    const MatrixXd clean = tools::unstacked(result.data.regressor * result.truth, count);
    result.data.outputs = clean + noise * MatrixXd::NullaryExpr(rows, count, [&] { return normal(engine); });
    return result;
}

bool all_consistent(const VectorXd& parameters) {
    bool consistent = true;
    for (Eigen::Index first = 0; first < parameters.size(); first += 10) {
        consistent = consistent && tools::is_consistent(parameters.segment<10>(first));
    }
    return consistent;
}

} // namespace

TEST_CASE("without noise the base parameters are exact for the whole arm and for the part beyond a sensor") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const OutputKind outputs : {OutputKind::joint_torque, OutputKind::wrench}) {
        const Experiment made = experiment(dfdyn::tests::icub_right_arm(), outputs, 300, 0, engine);
        const tools::BaseFit fit = tools::fit_base_parameters(made.data, made.base);
        const VectorXd truth = made.base.combination * made.truth;
        CHECK((fit.value - truth).norm() < 1e-9 * truth.norm());
        CHECK(tools::rms_error(made.data, fit.parameters).maxCoeff() < 1e-9);
        CHECK(tools::rms_error(made.data, made.data.nominal).minCoeff() > 1e-2);
        CHECK((fit.nominal - made.base.combination * made.data.nominal).norm() < 1e-12);
    }
}

TEST_CASE("the standard deviations match the errors of the estimates") {
    DFDYN_SEEDED_ENGINE(engine);
    const Experiment made = experiment(dfdyn::tests::ur5(), OutputKind::joint_torque, 400, 0.5, engine);
    const tools::BaseFit fit = tools::fit_base_parameters(made.data, made.base);
    const VectorXd ratio = (fit.value - made.base.combination * made.truth).cwiseQuotient(fit.deviation);
    // The squares of 36 standard normal variables have mean 1 and deviation 0.24, slightly more if
    // correlated.
    CHECK(ratio.squaredNorm() / static_cast<double>(ratio.size()) == Approx(1).margin(0.9));
    CHECK(fit.noise.deviation.minCoeff() == Approx(0.5).epsilon(0.15));
    CHECK(fit.noise.correlation_length.maxCoeff() < 1.5);
    CHECK(fit.condition > 1);
}

TEST_CASE("fewer equations than parameters determine no more parameters than equations") {
    DFDYN_SEEDED_ENGINE(engine);
    const Experiment made = experiment(dfdyn::tests::ur5(), OutputKind::joint_torque, 5, 0.5, engine);
    const tools::BaseFit fit = tools::fit_base_parameters(made.data, made.base);
    REQUIRE(fit.deviation.size() > 30);
    CHECK((fit.deviation.array() == std::numeric_limits<double>::infinity()).count() >=
          fit.deviation.size() - 30);
}

TEST_CASE("correlated noise increases the standard deviations") {
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<double> normal;
    Experiment made = experiment(dfdyn::tests::planar_arm(9.81), OutputKind::joint_torque, 2000, 0, engine);
    const VectorXd white = VectorXd::NullaryExpr(2000, [&] { return normal(engine); });
    VectorXd coloured = white;
    for (Eigen::Index t = 1; t < coloured.size(); ++t) {
        coloured[t] = 0.9 * coloured[t - 1] + std::sqrt(1 - 0.81) * white[t];
    }
    const MatrixXd clean = made.data.outputs;
    made.data.outputs = clean.colwise() + 0.1 * white;
    const VectorXd before = tools::fit_base_parameters(made.data, made.base).deviation;
    made.data.outputs = clean.colwise() + 0.1 * coloured;
    const tools::BaseFit after = tools::fit_base_parameters(made.data, made.base);
    CHECK(after.noise.correlation_length[0] == Approx(19).epsilon(0.3)); // 1.9 / 0.1
    CHECK((after.deviation.cwiseQuotient(before)).mean() == Approx(std::sqrt(19)).epsilon(0.25));
}

TEST_CASE("parameters that the motion does not excite stay nominal and are reported as undetermined") {
    const tools::Robot robot = dfdyn::tests::planar_arm(9.81);
    tools::RobotMotion motion = tools::random_motion(robot, 200, 2);
    motion.velocity.setZero(); // at rest gravity alone does not determine inertias
    motion.acceleration.setZero();
    const VectorXd nominal = tools::nominal_parameters(robot, OutputKind::joint_torque);
    const MatrixXd regressor = tools::stacked_regressor(robot, OutputKind::joint_torque, motion);
    const tools::BaseParameters base = tools::find_base_parameters(
        tools::stacked_regressor(robot, OutputKind::joint_torque, tools::random_motion(robot, 200, 1)));
    const tools::FitData data{regressor, tools::unstacked(regressor * (1.1 * nominal), 2), nominal};
    const tools::BaseFit fit = tools::fit_base_parameters(data, base);
    CHECK(tools::rms_error(data, fit.parameters).maxCoeff() < 1e-9);
    const std::vector<std::string> names = tools::parameter_names(robot, OutputKind::joint_torque);
    int inertias = 0;
    for (std::size_t i = 0; i < base.independent.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        const bool inertia = Catch::Matchers::ContainsSubstring("Izz").match(
            names[static_cast<std::size_t>(base.independent[i])]);
        inertias += inertia ? 1 : 0;
        CHECK(std::isinf(fit.deviation[row]) == inertia);
        CHECK(fit.determined[i] != inertia);
        CHECK(fit.value[row] == Approx((inertia ? 1.0 : 1.1) * fit.nominal[row]));
    }
    CHECK(inertias == 2);
}

TEST_CASE("consistent parameters are physical and predict as well as least squares") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const OutputKind outputs : {OutputKind::joint_torque, OutputKind::wrench}) {
        const Experiment made = experiment(dfdyn::tests::icub_right_arm(), outputs, 400, 0.05, engine);
        REQUIRE(all_consistent(made.truth));
        const tools::BaseFit fit = tools::fit_base_parameters(made.data, made.base);
        const VectorXd consistent = tools::fit_consistent_parameters(made.data, fit.noise);
        CHECK(all_consistent(consistent));
        const VectorXd left = tools::rms_error(made.data, consistent);
        const VectorXd least = tools::rms_error(made.data, fit.parameters);
        CHECK((left - least).cwiseAbs().maxCoeff() < 0.02 * 0.05);
        const VectorXd truth = made.data.regressor * made.truth;
        CHECK((made.data.regressor * consistent - truth).norm() <
              1.1 * (made.data.regressor * fit.parameters - truth).norm());
    }
}

TEST_CASE("for few noisy samples least squares give impossible bodies and the consistent fit does not") {
    DFDYN_SEEDED_ENGINE(engine);
    const Experiment made = experiment(dfdyn::tests::ur5(), OutputKind::joint_torque, 12, 5, engine);
    const tools::BaseFit fit = tools::fit_base_parameters(made.data, made.base);
    CHECK_FALSE(all_consistent(fit.parameters));
    const VectorXd consistent = tools::fit_consistent_parameters(made.data, fit.noise);
    CHECK(all_consistent(consistent));
    const MatrixXd elsewhere = tools::stacked_regressor(dfdyn::tests::ur5(), OutputKind::joint_torque,
                                                        tools::random_motion(dfdyn::tests::ur5(), 200, 9));
    CHECK((elsewhere * (consistent - made.truth)).norm() <
          (elsewhere * (fit.parameters - made.truth)).norm());
}

TEST_CASE("consistent parameters without informative data are the nominal ones") {
    const tools::Robot robot = dfdyn::tests::icub_right_arm();
    const VectorXd nominal = tools::nominal_parameters(robot, OutputKind::wrench);
    const tools::FitData data{MatrixXd::Zero(60, nominal.size()), MatrixXd::Zero(10, 6), nominal};
    const tools::FitNoise noise{VectorXd::Ones(6), VectorXd::Ones(6)};
    CHECK((tools::fit_consistent_parameters(data, noise) - nominal).norm() < 1e-9 * nominal.norm());
}

TEST_CASE("a fit of many samples has the values and deviations of a decomposition of all rows") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr Eigen::Index rows = 1300;
    const Experiment made =
        experiment(dfdyn::tests::planar_arm(9.81), OutputKind::joint_torque, rows, 0.1, engine);
    const tools::BaseFit fit = tools::fit_base_parameters(made.data, made.base);
    const VectorXd weight = fit.noise.deviation.cwiseInverse().replicate(rows, 1);
    const MatrixXd columns = weight.asDiagonal() * made.data.regressor(Eigen::all, made.base.independent);
    const MatrixXd inverse = tools::pseudo_inverse(columns);
    const VectorXd error =
        tools::stacked(made.data.outputs) - VectorXd(made.data.regressor * made.data.nominal);
    const VectorXd change = inverse * weight.cwiseProduct(error);
    CHECK((fit.value - fit.nominal - change).norm() < 1e-9 * change.norm());
    const VectorXd correlation = fit.noise.correlation_length.replicate(rows, 1);
    const VectorXd deviation = (inverse.cwiseAbs2() * correlation).cwiseSqrt();
    CHECK((fit.deviation - deviation).norm() < 1e-9 * deviation.norm());
}
