// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/run/plan_opponents.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/experiment/small_experiment.hpp"
#include "tools/experiment/run/train_case.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/replay/opponents/rigid_body.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace plan_opponents_test {

using namespace dfdyn::tools;
using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::small_plan;
using dfdyn::tests::TemporaryDirectory;
using dfdyn::tests::write_small_experiment;
using nlohmann::json;

PlanOpponents opponents_of(const TemporaryDirectory& directory, const json& content) {
    const Plan plan = read_plan(write_small_experiment(directory, content));
    return plan_opponents(plan, load_plan_data(plan));
}

TEST_CASE("the error of persistence in a plan follows its definition over all subsets") {
    const TemporaryDirectory directory;
    const Plan plan = read_plan(write_small_experiment(directory));
    const PlanData data = load_plan_data(plan);
    const PlanOpponents opponents = plan_opponents(plan, data);
    REQUIRE(opponents.errors.size() == 4);
    CHECK(opponents.errors[0].label == "persistence");
    std::vector<double> measured;
    double square = 0;
    for (const Recording& subset : data.subsets) {
        for (std::size_t row = 4; row < subset.row_count(); ++row) { // after the window of four lags
            measured.push_back(subset.output.row(row)[1]);
            square += std::pow(measured.back() - subset.output.row(row - 1)[1], 2);
        }
    }
    const auto count = static_cast<double>(measured.size());
    double mean = 0;
    for (const double value : measured) {
        mean += value / count;
    }
    double variation = 0;
    for (const double value : measured) {
        variation += (value - mean) * (value - mean);
    }
    CHECK(opponents.errors[0].normalised_error[1] == Approx(std::sqrt(square / variation)));
    CHECK(opponents.errors[1].normalised_error[1] < opponents.errors[0].normalised_error[1]);
}

TEST_CASE("a plan without a robot has no rigid body and gives the reason") {
    const TemporaryDirectory directory;
    const PlanOpponents opponents = opponents_of(directory, small_plan());
    CHECK(opponents.no_rigid_body == "the plan has no robot");
    CHECK(std::isnan(opponents.errors[2].normalised_error[0]));
    CHECK(std::isnan(opponents.errors[3].normalised_error[1]));
    json plan = small_plan();
    plan["robot"] = {{"urdf", "nowhere.urdf"}};
    CHECK_THAT(opponents_of(directory, plan).no_rigid_body, ContainsSubstring("nowhere.urdf"));
    plan["robot"] = {{"urdf", DFDYN_TEST_DATA_DIR "/robots/three_joint_arm/three_joint_arm.urdf"},
                     {"tip", "tool"}};
    CHECK_THAT(opponents_of(directory, plan).no_rigid_body, ContainsSubstring("expected joints"));
}

/// nRMSE over all subsets of the rigid bodies fitted to `recordings`, from the plan's largest window of four
/// lags on: by body, then by output.
std::vector<std::vector<double>> body_errors(const Plan& plan, const PlanData& data,
                                             std::span<const Recording> recordings) {
    const Robot robot = robot_of(plan.robot);
    const ChainModel chain = chain_model(robot, plan.outputs);
    std::vector<std::vector<double>> result;
    for (const RigidBodyFit& fit :
         fit_rigid_body(robot, chain, {1, 1}, plan.robot.sign_velocity, recordings)) {
        OutputError errors[2];
        for (const Recording& subset : data.subsets) {
            const Forecasts forecasts = rigid_body_forecasts(fit, chain, subset);
            for (std::size_t element = 4 * 2; element < forecasts.size(); ++element) {
                errors[element % 2].add(subset.output.values[element], forecasts[element]);
            }
        }
        result.push_back({errors[0].normalised(), errors[1].normalised()});
    }
    return result;
}

TEST_CASE("the rigid bodies of a plan are fitted to its training log") {
    const TemporaryDirectory directory;
    json content = small_plan();
    content["robot"] = {{"urdf", DFDYN_TEST_DATA_DIR "/robots/small_arm/small_arm.urdf"}, {"tip", "tool"}};
    const Plan plan = read_plan(write_small_experiment(directory, content));
    const PlanData data = load_plan_data(plan);
    const PlanOpponents torques = plan_opponents(plan, data);
    CHECK(torques.no_rigid_body.empty());
    const Recording training[] = {data.start, data.online};
    const auto expected = body_errors(plan, data, training);
    const auto of_tests = body_errors(plan, data, data.subsets);
    REQUIRE(expected.size() == 2);
    REQUIRE(of_tests.size() == 2);
    double largest_difference = 0; // from a fit to the recordings that it is tested with
    for (const std::size_t body : {0U, 1U}) {
        for (const std::size_t output : {0U, 1U}) {
            CAPTURE(body, output);
            const double error = torques.errors[2 + body].normalised_error[output];
            REQUIRE(std::isfinite(error));
            CHECK(error == Approx(expected[body][output]));
            largest_difference =
                std::max(largest_difference, std::abs(error - of_tests[body][output]) / error);
        }
    }
    CHECK(largest_difference > 1e-3);
}

} // namespace plan_opponents_test
