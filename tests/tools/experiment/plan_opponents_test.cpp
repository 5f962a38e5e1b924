// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/run/plan_opponents.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/experiment/small_experiment.hpp"

#include <cmath>

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

TEST_CASE("the rigid bodies of a plan are fitted to its training log") {
    const TemporaryDirectory directory;
    json plan = small_plan();
    plan["robot"] = {{"urdf", DFDYN_TEST_DATA_DIR "/robots/small_arm/small_arm.urdf"}, {"tip", "tool"}};
    const PlanOpponents torques = opponents_of(directory, plan);
    CHECK(torques.no_rigid_body.empty());
    for (const std::size_t opponent : {2U, 3U}) {
        for (const double error : torques.errors[opponent].normalised_error) {
            CHECK(std::isfinite(error));
            CHECK(error < 1.5); // small_recording() does not contain the torques of this robot
        }
    }
}

} // namespace plan_opponents_test
