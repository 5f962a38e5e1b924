// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/plan/plan_data.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/experiment/small_experiment.hpp"
#include "tools/base/text/error.hpp"

#include <string>
#include <vector>

namespace plan_data_test {

using namespace dfdyn::tools;
using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::small_plan;
using dfdyn::tests::small_recording;
using dfdyn::tests::TemporaryDirectory;
using dfdyn::tests::write_small_experiment;
using nlohmann::json;

TEST_CASE("the recordings of a plan are cut as configured") {
    const TemporaryDirectory directory;
    const Plan plan = read_plan(write_small_experiment(directory));
    const PlanData data = load_plan_data(plan);
    CHECK(data.start.row_count() == 150);
    CHECK(data.online.row_count() == 150);
    CHECK(data.online.time_s.front() == Approx(7.5));
    REQUIRE(data.subsets.size() == 2);
    CHECK(data.subsets[1].row_count() == 100);
    CHECK(data.subsets[1].time_s.front() == Approx(5));
    CHECK(data.group_outputs == std::vector<std::vector<std::size_t>>{{0}, {0, 1}});
    double mean = 0;
    double square = 0;
    for (const Recording& subset : data.subsets) {
        for (std::size_t row = 0; row < 100; ++row) {
            mean += subset.output.row(row)[1] / 200;
            square += subset.output.row(row)[1] * subset.output.row(row)[1] / 200;
        }
    }
    CHECK(data.output_variance[1] == Approx(square - mean * mean));
}

TEST_CASE("recordings without the rows or columns of the plan are rejected") {
    const TemporaryDirectory directory;
    json content = small_plan();
    content["tests"][0]["count"] = 3;
    const Plan too_long = read_plan(write_small_experiment(directory, content));
    CHECK_THROWS_WITH(load_plan_data(too_long),
                      ContainsSubstring("expected at least 300 rows in the recording, found 220"));
    content = small_plan();
    content["groups"][1]["outputs"] = {"tau1", "tau3"};
    const Plan unknown = read_plan(write_small_experiment(directory, content));
    CHECK_THROWS_WITH(load_plan_data(unknown),
                      ContainsSubstring("group \"both\": expected outputs among tau1, tau2, found \"tau3\""));
}

TEST_CASE("a plan is refused if a recording has another sample period than the start of the training") {
    const TemporaryDirectory directory;
    const Plan plan = read_plan(write_small_experiment(directory));
    CHECK_NOTHROW(load_plan_data(plan));
    for (const double period_s : {0.02, 0.2}) {
        CAPTURE(period_s);
        directory.write("test.csv", small_recording(220, 2.6, period_s));
        CHECK_THROWS_AS(load_plan_data(plan), InputError);
        CHECK_THROWS_WITH(load_plan_data(plan),
                          ContainsSubstring("test.csv: expected a row every 0.05 s, as in the training of "
                                            "plan \"small\", found one every "));
    }
    directory.write("test.csv", small_recording(220, 2.6));
    // The log's rows after the start, which begin at 7.5 s, are closer than those of the start.
    std::string text = small_recording(150, 2);
    for (int row = 0; row < 150; ++row) {
        text += std::to_string(7.5 + 0.01 * row) + ",0,0,0,0\n";
    }
    directory.write("train.csv", text);
    CHECK_THROWS_WITH(load_plan_data(plan), ContainsSubstring("train.csv: expected a row every 0.05 s"));
}

TEST_CASE("a quick plan accepts every training log that the plan itself accepts") {
    const TemporaryDirectory directory;
    const Plan plan = read_plan(write_small_experiment(directory)); // 300 rows, without a limit
    Plan quick = quick_plan(plan);
    CHECK(load_plan_data(quick).online.row_count() == load_plan_data(plan).online.row_count());
    quick.most_online_rows = 20;
    CHECK(load_plan_data(quick).online.row_count() == 20);
}

} // namespace plan_data_test
