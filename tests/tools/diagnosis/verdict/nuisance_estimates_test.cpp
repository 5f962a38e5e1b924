// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/nuisance_estimates.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <cmath>

namespace nuisance_estimates_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A model that has only nuisance parameters: the first `masses` are masses, each has a standard deviation of
/// 0.02.
FittedEffects of_nuisance(const VectorXd& coefficients, Index masses) {
    FittedEffects fitted_effects;
    fitted_effects.values.coefficients = coefficients;
    fitted_effects.values.covariance = 4e-4 * MatrixXd::Identity(coefficients.size(), coefficients.size());
    fitted_effects.nuisance.resize(static_cast<std::size_t>(coefficients.size()));
    fitted_effects.uncertain_masses = masses;
    return fitted_effects;
}

TEST_CASE("mass estimates of the nuisance parameters are listed with the masses in the robot's file") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const VectorXd errors{{0.05, -0.02, 0, 0.1, -0.1, 0.01}};
    const VectorXd nominal = nominal_parameters(signals.robot, signals.kind);
    const std::vector<NuisanceEstimate> nuisance_estimates =
        estimate_nuisances(signals, of_nuisance(errors, 6), VectorXd::Ones(6));
    REQUIRE(nuisance_estimates.size() == 6);
    for (Index link = 0; link < 6; ++link) {
        const NuisanceEstimate& one = nuisance_estimates[static_cast<std::size_t>(link)];
        const double mass = nominal[10 * link];
        CHECK(one.where == "link" + std::to_string(link + 1));
        CHECK(one.parameter.name == "mass");
        CHECK(one.given.value() == mass);
        CHECK(one.parameter.value == Approx(mass * (1 + errors[link])));
        CHECK(one.parameter.high - one.parameter.value ==
              Approx(mass * 1.96 * std::hypot(1.7 * 0.02, 0.04 * errors[link])));
        CHECK(one.parameter.value - one.parameter.low == Approx(one.parameter.high - one.parameter.value));
    }
}

TEST_CASE("the mass estimates of a wrench belong to the links beyond the F/T sensor") {
    const DiagnosisSignals signals = signals_of(icub_right_arm(), OutputKind::wrench);
    const Index bodies = nominal_parameters(signals.robot, signals.kind).size() / 10;
    const std::vector<NuisanceEstimate> nuisance_estimates =
        estimate_nuisances(signals, of_nuisance(VectorXd::Zero(bodies), bodies), VectorXd::Ones(6));
    REQUIRE(std::ssize(nuisance_estimates) == bodies);
    CHECK(nuisance_estimates.back().where == "link" + std::to_string(signals.joints()));
}

TEST_CASE("unknown torque constants are estimated and have no upper bound where the data set none") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::motor_current);
    const VectorXd gains = VectorXd::LinSpaced(6, 0.1, 0.2); // A/(N·m)
    VectorXd errors{{0.25, 0, 0, -0.5, 0.1, -1.2}};
    FittedEffects fitted_effects = of_nuisance(errors, 0);
    fitted_effects.values.covariance(3, 3) = 1;
    const std::vector<NuisanceEstimate> nuisance_estimates =
        estimate_nuisances(signals, fitted_effects, gains);
    REQUIRE(nuisance_estimates.size() == 6);
    const auto& parameter = [&](std::size_t joint) -> const FoundParameter& {
        return nuisance_estimates[joint].parameter;
    };
    CHECK(nuisance_estimates.front().where == "actuator1");
    CHECK_FALSE(nuisance_estimates.front().given);
    CHECK(parameter(0).name == "torque_constant");
    CHECK(parameter(0).value == Approx(1 / (0.1 * 1.25)));
    const double reach = 1.96 * std::hypot(1.7 * 0.02, 0.04 * 0.25);
    CHECK(parameter(0).low == Approx(1 / (0.1 * (1.25 + reach))));
    CHECK(parameter(0).high == Approx(1 / (0.1 * (1.25 - reach))));
    CHECK(parameter(1).value == Approx(1 / 0.12));
    CHECK(std::isinf(parameter(3).high));
    CHECK(parameter(3).low > 0);
    CHECK(parameter(5).value == Approx(1 / 0.2)); // a gain is never negative
}

} // namespace nuisance_estimates_test
