// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/run/run_plan.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/experiment/small_experiment.hpp"
#include "tools/build_flags.hpp"
#include "tools/experiment/plan/file_checksum.hpp"
#include "tools/experiment/run/job_file.hpp"
#include "tools/experiment/run/run_job.hpp"
#include "tools/replay/replay.hpp"

#include <cmath>
#include <limits>

namespace run_plan_test {

using namespace dfdyn::tools;
using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::small_plan;
using dfdyn::tests::TemporaryDirectory;
using dfdyn::tests::write_small_experiment;
using nlohmann::json;

void ignore(double /*share*/) {}

/// Reads and runs the plan in `directory`; the results are in its folder `out`.
EvaluationResults run(const TemporaryDirectory& directory, int jobs = 1) {
    const Plan plan = read_plan(directory.path() / "plan.json");
    const PlanData data = load_plan_data(plan);
    return run_plan(plan, data, {directory.path() / "out", jobs, false}, ignore);
}

CaseMemories empty_memories(const Plan& plan) {
    CaseMemories memories;
    for (const Case& one : plan.cases) {
        memories.try_emplace(one.name);
    }
    return memories;
}

/// All results except the times.
json without_times(const EvaluationResults& results) {
    json all = json::array();
    for (const JobResult& job : results.jobs) {
        all.push_back(json(job_to_json(job)));
        all.back().erase("median_us");
    }
    return all;
}

TEST_CASE("a run computes every case with every draw and reuses its results") {
    const TemporaryDirectory directory;
    write_small_experiment(directory);
    const EvaluationResults first = run(directory);
    REQUIRE(first.jobs.size() == 4);
    CHECK(first.failed.empty());
    CHECK(first.reused == 0);
    CHECK(first.jobs[1].case_name == "NP-ML-STD");
    CHECK(first.jobs[1].seed == 2);
    CHECK(first.jobs[2].case_name == "NP-ML-DFR");
    CHECK(first.jobs[2].columns == 20);
    CHECK(first.jobs[0].error != first.jobs[1].error); // the draws have different features
    const std::filesystem::path file = directory.path() / "out/cases/NP-ML-DFR/2.json";
    const auto written = std::filesystem::last_write_time(file);
    const EvaluationResults second = run(directory);
    CHECK(second.reused == 4);
    CHECK(std::filesystem::last_write_time(file) == written);
    json again = without_times(second);
    CHECK(again == without_times(first));
}

TEST_CASE("only units with changed inputs run again") {
    const TemporaryDirectory directory;
    write_small_experiment(directory);
    run(directory);
    json plan = small_plan();
    SECTION("other words: none") {
        plan["title"] = "Another title";
        directory.write("plan.json", plan.dump());
        CHECK(run(directory).reused == 4);
    }
    SECTION("one more draw and one more case: the new ones") {
        plan["draws"] = 3;
        plan["cases"][0]["input"] = {"STD", "DFR", "DF"};
        directory.write("plan.json", plan.dump());
        const EvaluationResults results = run(directory);
        CHECK(results.jobs.size() == 9);
        CHECK(results.reused == 4);
    }
    SECTION("a setting of one case: that one") {
        plan["cases"] = {{{"input", "STD"}}, {{"input", "DFR"}, {"features", 11}}};
        directory.write("plan.json", plan.dump());
        CHECK(run(directory).reused == 2);
    }
    SECTION("how it is trained, one case: that one") {
        plan["cases"] = {{{"input", "STD"}, {"relevance", false}}, {{"input", "DFR"}}};
        directory.write("plan.json", plan.dump());
        CHECK(run(directory).reused == 2);
        plan["cases"] = {{{"input", "STD"}, {"relevance", false}}, {{"input", "DFR"}, {"centred", false}}};
        directory.write("plan.json", plan.dump());
        CHECK(run(directory).reused == 2);
    }
    SECTION("the protocol: all") {
        plan["horizon"] = 6;
        directory.write("plan.json", plan.dump());
        CHECK(run(directory).reused == 0);
    }
    SECTION("a recording: all") {
        directory.write("test.csv", dfdyn::tests::small_recording(220, 2.61));
        CHECK(run(directory).reused == 0);
    }
    SECTION("the robot: all") {
        directory.write("robot.urdf", "<robot/>");
        plan["robot"] = {{"urdf", "robot.urdf"}};
        directory.write("plan.json", plan.dump());
        CHECK(run(directory).reused == 0);
        CHECK(run(directory).reused == 4);
        directory.write("robot.urdf", "<robot name=\"other\"/>");
        CHECK(run(directory).reused == 0);
    }
    SECTION("a file that was cut or is another's: that one") {
        const std::filesystem::path file = directory.path() / "out/cases/NP-ML-DFR/2.json";
        std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
        CHECK(run(directory).reused == 3);
        std::filesystem::copy_file(directory.path() / "out/cases/NP-ML-DFR/1.json", file,
                                   std::filesystem::copy_options::overwrite_existing);
        CHECK(run(directory).reused == 3);
        CHECK(run(directory).reused == 4);
    }
}

TEST_CASE("the inputs of a unit contain the program's checksum") {
    const TemporaryDirectory directory;
    // The standard check value of CRC-32.
    CHECK(file_checksum(directory.write("text", "123456789")) == "cbf43926, 9 bytes");
    const Plan plan = read_plan(write_small_experiment(directory));
    const std::string program = job_inputs(plan, load_plan_data(plan), plan.cases[0], 1)["program"];
    CHECK_THAT(program, ContainsSubstring(build_flags()));
    CHECK_THAT(program, ContainsSubstring(file_checksum("/proc/self/exe")));
}

TEST_CASE("a unit without learned ticks or with lost ticks is read back as written") {
    const TemporaryDirectory directory;
    JobResult job;
    job.case_name = "A";
    job.median_us = std::nan("");
    job.error = {{{std::nan(""), std::numeric_limits<double>::infinity(), 0.5}}};
    const nlohmann::ordered_json inputs{{"seed", 1}};
    write_job(directory.path() / "1.json", inputs, job);
    const auto read = read_job(directory.path() / "1.json", inputs);
    REQUIRE(read);
    CHECK(std::isnan(read->median_us));
    CHECK(std::isnan(read->error[0][0][0]));
    CHECK(std::isinf(read->error[0][0][1]));
    CHECK(read->error[0][0][2] == 0.5);
}

TEST_CASE("the first draws of all cases run before any second draw") {
    const TemporaryDirectory directory;
    write_small_experiment(directory);
    run(directory);
    const auto written = [&directory](const std::string& file) {
        return std::filesystem::last_write_time(directory.path() / "out/cases" / file);
    };
    // Several cases without tuning may have equal file times; the tuning of DFR takes longer.
    CHECK(written("NP-ML-STD/1.json") < written("NP-ML-DFR/1.json"));
    CHECK(written("NP-ML-DFR/1.json") <= written("NP-ML-STD/2.json"));
    CHECK(written("NP-ML-STD/2.json") <= written("NP-ML-DFR/2.json"));
}

TEST_CASE("several jobs give the same results in the same order as one") {
    const TemporaryDirectory serial;
    const TemporaryDirectory parallel;
    json plan = small_plan();
    plan["draws"] = 4;
    write_small_experiment(serial, plan);
    write_small_experiment(parallel, plan);
    const EvaluationResults results = run(parallel, 3);
    CHECK(results.jobs.size() == 8);
    CHECK(without_times(results) == without_times(run(serial, 1)));
}

TEST_CASE("a case that fails does not stop the others and is tried again") {
    const TemporaryDirectory directory;
    json plan = small_plan();
    plan["cases"].push_back({{"model", "NP"}, {"input", "DFR"}, {"rows_per_joint", 9}, {"suffix", "-wide"}});
    write_small_experiment(directory, plan);
    for (int attempt = 0; attempt < 2; ++attempt) {
        const EvaluationResults results = run(directory);
        CHECK(results.jobs.size() == 4);
        REQUIRE(results.failed.size() == 2);
        CHECK(results.failed[1].case_name == "NP-ML-DFR-wide");
        CHECK(results.failed[1].seed == 2);
        CHECK_THAT(results.failed[1].reason, ContainsSubstring("1 to lags + 1 rows per joint"));
    }
}

TEST_CASE("a result that cannot be written ends the run") {
    const TemporaryDirectory directory;
    write_small_experiment(directory);
    std::filesystem::create_directories(directory.path() / "out/cases");
    directory.write("out/cases/NP-ML-STD", ""); // in the place of the first case's folder
    CHECK_THROWS_WITH(run(directory), ContainsSubstring("NP-ML-STD: cannot make the folder"));
    CHECK_FALSE(std::filesystem::exists(directory.path() / "out/cases/NP-ML-DFR"));
}

TEST_CASE("all cases are scored at the same ticks") {
    const TemporaryDirectory directory;
    json plan = small_plan();
    plan["cases"].push_back({{"input", "DFR"}, {"lags", 9}, {"suffix", "-long"}});
    write_small_experiment(directory, plan);
    const EvaluationResults results = run(directory);
    REQUIRE(results.jobs.size() == 6);
    for (const JobResult& job : results.jobs) {
        CAPTURE(job.case_name, job.seed);
        for (std::size_t tick = 0; tick < 100; ++tick) {
            const bool scored = tick >= 9 && tick < 95;
            CHECK(std::isfinite(job.error[0][1][tick]) == scored);
            CHECK(std::isnan(job.error[0][1][tick]) == !scored);
        }
    }
}

TEST_CASE("a unit equals the written-out protocol") {
    const TemporaryDirectory directory;
    const Plan plan = read_plan(write_small_experiment(directory));
    const PlanData data = load_plan_data(plan);
    CaseMemories memories = empty_memories(plan);
    const JobResult job = run_job(plan, data, plan.cases[1], 7, memories, 2, ignore);

    CaseMemory other;
    const TrainedModel model =
        train_case(plan.cases[1], {plan.robot, plan.outputs, data.start}, 7, other, ignore);
    for (std::size_t subset = 0; subset < 2; ++subset) {
        const auto estimator = make_estimator(model, false);
        replay(*estimator, {&model, 1}, data.online, 0, [](std::size_t) {});
        estimator->begin_recording();
        const ReplayedRecording replayed =
            replay(*estimator, {&model, 1}, data.subsets[subset], plan.horizon, [](std::size_t) {});
        REQUIRE(replayed.horizon.size() == 100 - 4 - 5);
        CHECK(std::isnan(job.error[1][subset][3])); // the window is still filling
        for (const HorizonIndex& index : replayed.horizon) {
            CHECK(job.error[0][subset][index.tick] == index.epsilon[0]);
            CHECK(job.error[1][subset][index.tick] == Approx((index.epsilon[0] + index.epsilon[1]) / 2));
        }
    }
}

TEST_CASE("the error relative to the variance is the squared error of the horizon divided by it") {
    const TemporaryDirectory directory;
    json content = small_plan();
    const Plan relative = read_plan(write_small_experiment(directory, content));
    content["error_scale"] = "variance";
    const Plan plan = read_plan(write_small_experiment(directory, content));
    const PlanData data = load_plan_data(plan);
    CaseMemories memories = empty_memories(plan);
    const JobResult by_horizon = run_job(relative, data, plan.cases[1], 1, memories, 2, ignore);
    const JobResult by_variance = run_job(plan, data, plan.cases[1], 1, memories, 2, ignore);
    const Recording& subset = data.subsets[1];
    for (std::size_t tick = 4; tick < 90; ++tick) {
        double square = 0;
        for (std::size_t s = 1; s <= 5; ++s) {
            square += std::pow(subset.output.row(tick + s)[0], 2);
        }
        CHECK(by_variance.error[0][1][tick] * 5 * data.output_variance[0] ==
              Approx(by_horizon.error[0][1][tick] * square));
    }
}

TEST_CASE("the result does not depend on the draw that tunes the hyperparameters") {
    const TemporaryDirectory directory;
    const Plan plan = read_plan(write_small_experiment(directory));
    const PlanData data = load_plan_data(plan);
    CaseMemory fresh;
    CaseMemory used;
    train_case(plan.cases[1], {plan.robot, plan.outputs, data.start}, 1, used, ignore);
    const TrainedModel a =
        train_case(plan.cases[1], {plan.robot, plan.outputs, data.start}, 2, fresh, ignore);
    const TrainedModel b = train_case(plan.cases[1], {plan.robot, plan.outputs, data.start}, 2, used, ignore);
    CHECK(a.features.omega == b.features.omega);
    CHECK(a.input.rows == b.input.rows);
    CHECK(a.start.weights == b.start.weights);
}

/// ε of the first subset for the first draw of the plan's first two cases, running as one estimator.
std::vector<HorizonIndex> errors_together(const Plan& plan, const PlanData& data) {
    std::vector<TrainedModel> members;
    for (const std::size_t member : {0U, 1U}) {
        CaseMemory memory;
        members.push_back(
            train_case(plan.cases[member], {plan.robot, plan.outputs, data.start}, 1, memory, ignore));
    }
    const auto estimator = make_estimator(members, false);
    replay(*estimator, members, data.online, 0, [](std::size_t) {});
    REQUIRE(estimator->restore(estimator->snapshot()));
    return replay(*estimator, members, data.subsets[0], plan.horizon, [](std::size_t) {}).horizon;
}

TEST_CASE("the error of a combination is that of its members' models in one estimator") {
    const TemporaryDirectory directory;
    json content = small_plan();
    content["cases"].push_back({{"combine", {"NP-ML-STD", "NP-ML-DFR"}}, {"name", "both-of-them"}});
    const Plan plan = read_plan(write_small_experiment(directory, content));
    const PlanData data = load_plan_data(plan);
    CaseMemories memories = empty_memories(plan);
    const JobResult job = run_job(plan, data, plan.cases[2], 1, memories, 2, ignore);
    const JobResult member = run_job(plan, data, plan.cases[1], 1, memories, 2, ignore);
    const std::vector<HorizonIndex> together = errors_together(plan, data);
    REQUIRE(together.size() >= 100 - 4 - 5);
    for (const HorizonIndex& index : together) {
        CHECK(job.error[0][0][index.tick] == index.epsilon[0]);
        CHECK(job.error[0][0][index.tick] != member.error[0][0][index.tick]);
    }
}

TEST_CASE("a combination of cases combines their models and runs again if a member changes") {
    const TemporaryDirectory directory;
    json plan = small_plan();
    plan["cases"].push_back({{"combine", {"NP-ML-STD", "NP-ML-DFR"}}, {"name", "both-of-them"}});
    write_small_experiment(directory, plan);
    const EvaluationResults results = run(directory);
    REQUIRE(results.jobs.size() == 6);
    const JobResult& combined = results.jobs[4];
    CHECK(combined.case_name == "both-of-them");
    CHECK(combined.columns == 40);
    // The combination errs less than the worse of its members.
    for (const std::size_t group : {0U, 1U}) {
        const auto sum_of = [group](const JobResult& job) {
            double sum = 0;
            for (const double error : job.error[group][0]) {
                sum += std::isfinite(error) ? error : 0;
            }
            return sum;
        };
        CHECK(sum_of(combined) < std::max(sum_of(results.jobs[0]), sum_of(results.jobs[2])));
        CHECK(sum_of(combined) > 0);
    }
    CHECK(run(directory).reused == 6);
    plan["defaults"]["lags"] = 5; // of every case
    directory.write("plan.json", plan.dump());
    CHECK(run(directory).reused == 0);
}

} // namespace run_plan_test
