// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/plan/plan.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/experiment/small_experiment.hpp"
#include "tools/base/text/error.hpp"
#include "tools/experiment/plan/plan_data.hpp"

#include <array>
#include <functional>

namespace plan_test {

using namespace dfdyn::tools;
using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::small_plan;
using dfdyn::tests::TemporaryDirectory;
using nlohmann::json;

Plan plan_of(const json& content) {
    const TemporaryDirectory directory;
    return read_plan(directory.write("plan.json", content.dump()));
}

std::vector<std::string> case_names(const Plan& plan) {
    std::vector<std::string> names;
    for (const Case& one : plan.cases) {
        names.push_back(one.name);
    }
    return names;
}

TEST_CASE("a plan is read with its defaults and with paths relative to its folder") {
    const TemporaryDirectory directory;
    const Plan plan = read_plan(directory.write("plan.json", small_plan().dump()));
    CHECK(plan.training_log == directory.path() / "train.csv");
    CHECK(plan.start_rows == 150);
    REQUIRE(plan.tests.size() == 1);
    CHECK(plan.tests[0].log == directory.path() / "test.csv");
    CHECK(plan.tests[0].first == 0);
    CHECK(plan.tests[0].count == 2);
    CHECK(plan.seeds == std::vector<std::uint64_t>{1, 2});
    CHECK(plan.error_scale == ErrorScale::horizon);
    REQUIRE(plan.figures.size() == 1); // one figure with all cases by default
    CHECK(plan.figures[0].cases == case_names(plan));
    CHECK(plan.cases[0].lags == 4);
    CHECK(plan.cases[0].feature_count == 10);
    CHECK(plan.cases[0].rows_per_joint == 3);
    CHECK(plan.cases[0].physics_input == "same");
}

TEST_CASE("lists in a case give all combinations and name the cases") {
    json content = small_plan();
    content["cases"] = json::parse(R"([
        {"model": ["NP", "SPK"], "input": ["STD", "DFR"]},
        {"model": "SP2", "hyper": ["ML", "CV"], "input": "DFSR"},
        {"input": "DFR", "rows_per_joint": [1, 2]},
        {"model": "SPK", "physics_input": "own", "suffix": "-own", "lags": 7}])");
    const Plan plan = plan_of(content);
    CHECK(case_names(plan) == std::vector<std::string>{"NP-ML-STD", "NP-ML-DFR", "SPK-ML-STD", "SPK-ML-DFR",
                                                       "SP2-ML-DFSR", "SP2-CV-DFSR", "NP-ML-DFR-k1",
                                                       "NP-ML-DFR-k2", "SPK-ML-DFR-own"});
    CHECK(plan.cases[6].rows_per_joint == 1);
    CHECK(plan.cases[7].rows_per_joint == 2);
    CHECK(plan.cases[8].physics_input == "own");
    CHECK(plan.cases[8].lags == 7);
    CHECK(plan.cases[7].lags == 4);
}

TEST_CASE("comparisons give all combinations of lists and of groups if none is named") {
    json content = small_plan();
    content["findings"] = json::parse(R"([{"name": "n", "statement": "s", "comparisons": [
        {"better": ["NP-ML-STD", "NP-ML-DFR"], "worse": "NP-ML-STD", "phase": "steady", "gain": 0.1},
        {"better": "NP-ML-DFR", "worse": "NP-ML-STD", "group": "both", "phase": "transient"}]}])");
    const Plan plan = plan_of(content);
    REQUIRE(plan.findings.size() == 1);
    const std::vector<Comparison>& comparisons = plan.findings[0].comparisons;
    REQUIRE(comparisons.size() == 5);
    CHECK(comparisons[1].better == "NP-ML-STD");
    CHECK(comparisons[1].group == "both");
    CHECK(comparisons[1].gain == 0.1);
    CHECK(comparisons[4].phase == Phase::transient);
    CHECK(comparisons[4].gain == 0);
}

TEST_CASE("a comparison can refer to all cases without suffix as a set") {
    json content = small_plan();
    content["more_cases"] = {{{"input", {"STD", "DF"}}, {"suffix", "-own"}}};
    content["comparisons"] = json::parse(R"([
        {"better": "NP-ML-DF-own", "worse": "paper", "group": "both", "phase": "steady"},
        {"better": ["paper", "NP-ML-DF-own"], "worse": "NP-ML-STD-own", "group": "both", "phase": "steady"}])");
    const Plan plan = plan_of(content);
    std::vector<std::pair<std::string, std::string>> pairs;
    for (const Comparison& comparison : plan.comparisons) {
        pairs.emplace_back(comparison.better, comparison.worse);
    }
    CHECK(pairs == std::vector<std::pair<std::string, std::string>>{{"NP-ML-DF-own", "NP-ML-STD"},
                                                                    {"NP-ML-DF-own", "NP-ML-DFR"},
                                                                    {"NP-ML-STD", "NP-ML-STD-own"},
                                                                    {"NP-ML-DFR", "NP-ML-STD-own"},
                                                                    {"NP-ML-DF-own", "NP-ML-STD-own"}});
}

TEST_CASE("additional figures follow the default one") {
    json content = small_plan();
    content["more_figures"] = {{{"title", "One"}, {"cases", {"NP-ML-DFR"}}}};
    const Plan plan = plan_of(content);
    REQUIRE(plan.figures.size() == 2);
    CHECK(plan.figures[0].cases.size() == 2);
    CHECK(plan.figures[1].title == "One");
}

TEST_CASE("the settings of training and of the robot are read") {
    json content = small_plan();
    content["defaults"]["relevance"] = false;
    content["cases"] =
        json::parse(R"([{"input": "STD", "centred": false}, {"input": "DF", "relevance": true}])");
    content["robot"] = json::parse(R"({"urdf": "r.urdf", "gravity": [0, 9.8, 1], "sign_velocity": 0.01,
                                       "torque_constants": [10, 7.5]})");
    const Plan plan = plan_of(content);
    CHECK_FALSE(plan.cases[0].relevance);
    CHECK_FALSE(plan.cases[0].centred);
    CHECK(plan.cases[1].relevance);
    CHECK(plan.cases[1].centred);
    CHECK(plan.robot.gravity == std::array<double, 3>{0, 9.8, 1});
    CHECK(plan.robot.sign_velocity == 0.01);
    CHECK(plan.robot.torque_constants == std::vector<double>{10, 7.5});
}

TEST_CASE("an error in a plan is reported with its field") {
    struct Mistake {
        std::function<void(json&)> make;
        std::string message;
    };
    const auto mistake = GENERATE(values<Mistake>({
        {[](json& j) { j["schema"] = "dfdyn.plan/2"; }, "plan.json: schema: expected \"dfdyn.plan/1\""},
        {[](json& j) { j["drows"] = 3; }, "plan.json: field \"drows\": expected one of schema, name,"},
        {[](json& j) { j["training"]["row"] = 3; },
         "training.field \"row\": expected one of log, start_rows"},
        {[](json& j) { j["cases"][0]["imput"] = "DF"; }, "cases[0].field \"imput\": expected one of model,"},
        {[](json& j) { j.erase("title"); }, "title: expected this field, found none"},
        {[](json& j) { j["name"] = "a/b"; }, "name: expected letters, digits, - and _, found \"a/b\""},
        {[](json& j) { j["outputs"] = "wind"; }, "outputs: expected tau, i or wrench, found \"wind\""},
        {[](json& j) { j["training"]["start_rows"] = 3; }, "training.start_rows: expected a whole number"},
        {[](json& j) { j["tests"] = json::array(); }, "tests: expected 1 to 10000 objects, found 0"},
        {[](json& j) { j["tests"][0]["rows"] = -1; }, "tests[0].rows: expected a whole number from 2"},
        {[](json& j) { j["tests"][0] = 3; }, "tests[0]: expected an object"},
        {[](json& j) { j["horizon"] = 0; }, "horizon: expected a whole number from 1"},
        {[](json& j) { j["error_scale"] = "x"; }, "error_scale: expected horizon or variance, found \"x\""},
        {[](json& j) {
             j["seeds"] = {1, 1};
         },
         "seeds: expected at least one, each once"},
        {[](json& j) { j["groups"][1]["name"] = "first"; }, "groups: expected names that are there once"},
        {[](json& j) {
             j["groups"][1]["outputs"] = {"tau1", "tau2", "tau1"};
         },
         "groups[1].outputs: expected names that are there once, found \"tau1\" twice"},
        {[](json& j) { j["tests"][0]["rows"] = 9; },
         "tests[0].rows: expected more than 9, the horizon and the largest lags of a case together, found 9"},
        {[](json& j) { j["horizon"] = 100; }, "tests[0].rows: expected more than 104"},
        {[](json& j) {
             j["cases"][0]["input"] = {"DF", "DFX"};
         },
         "cases[0].input: expected one of STD"},
        {[](json& j) { j["cases"][0]["model"] = "XP"; }, "cases[0].model: expected one of NP, P, SP"},
        {[](json& j) { j["cases"][0]["hyper"] = "XP"; }, "cases[0].hyper: expected one of ML, CV"},
        {[](json& j) { j["cases"][0]["suffix"] = "/../"; }, "cases[0].suffix: expected letters"},
        {[](json& j) {
             j["cases"][0]["effects"] = {"viscous_friction", "viscous"};
         },
         "plan.json: cases[0].effects: expected one of"},
        {[](json& j) { j["defaults"]["effects"] = "bias"; }, "defaults.effects: expected one of"},
        {[](json& j) { j["cases"][0]["centred"] = 1; }, "cases[0].centred: expected true or false"},
        {[](json& j) {
             j["robot"] = {{"urdf", "r"}, {"gravity", {0, 1}}};
         },
         "robot.gravity: expected 3 numbers"},
        {[](json& j) {
             j["robot"] = {{"urdf", "r"}, {"sign_velocity", 0}};
         },
         "robot.sign_velocity: expected a positive number"},
        {[](json& j) {
             j["robot"] = {{"urdf", "r"}, {"torque_constants", {1, -1}}};
         },
         "robot.torque_constants"},
        {[](json& j) {
             j["comparisons"] = {{{"better", "NP-ML-STD"}, {"worse", "papers"}, {"phase", "steady"}}};
         },
         "comparisons[0].worse: expected one of"},
        {[](json& j) { j["cases"].push_back(j["cases"][0]); }, "\"NP-ML-STD\" twice"},
        {[](json& j) { j["defaults"]["features"] = 0; }, "defaults.features: expected a whole number from 1"},
        {[](json& j) {
             j["cases"].push_back({{"combine", {"NP-ML-STD", "no"}}, {"name", "c"}});
         },
         "cases: \"c\": combine: expected names of cases that are no combinations, found \"no\""},
        {[](json& j) {
             j["cases"].push_back({{"combine", {"NP-ML-STD", "NP-ML-DFR"}}, {"name", "paper"}});
         },
         "cases[1].name: expected another name than that of the set of all cases without a suffix, found "
         "\"paper\""},
        {[](json& j) {
             j["cases"].push_back({{"combine", {"NP-ML-STD"}}, {"name", "c"}, {"lags", 3}});
         },
         "lags"},
        {[](json& j) { j["defaults"]["forgetting"] = 2; }, "defaults.forgetting: expected a number from 0.5"},
        {[](json& j) {
             j["figures"] = {{{"title", "f"}, {"cases", {"NP-ML-DF"}}}};
         },
         "figures[0].cases: expected one of NP-ML-STD, NP-ML-DFR, found \"NP-ML-DF\""},
        {[](json& j) {
             j["comparisons"] = {{{"better", "NP-ML-STD"}, {"worse", "no"}, {"phase", "steady"}}};
         },
         "comparisons[0].worse: expected one of"},
        {[](json& j) {
             j["comparisons"] = {{{"better", "NP-ML-STD"}, {"worse", "NP-ML-DFR"}, {"phase", "late"}}};
         },
         "comparisons[0].phase: expected transient or steady, found \"late\""},
    }));
    CAPTURE(mistake.message);
    json content = small_plan();
    mistake.make(content);
    CHECK_THROWS_AS(plan_of(content), InputError);
    CHECK_THROWS_WITH(plan_of(content), ContainsSubstring(mistake.message));
}

TEST_CASE("a missing plan or one that is not JSON is an error of one line") {
    const TemporaryDirectory directory;
    CHECK_THROWS_AS(read_plan(directory.path() / "none.json"), InputError);
    CHECK_THROWS_WITH(read_plan(directory.write("plan.json", "{\"schema\": ")),
                      ContainsSubstring("plan.json: byte"));
}

TEST_CASE("rows of the training cannot be test rows of the same log") {
    const TemporaryDirectory directory;
    json content = small_plan();
    const auto plan = [&] { return read_plan(dfdyn::tests::write_small_experiment(directory, content)); };
    content["tests"][0]["log"] = "./train.csv"; // another path of the same file
    CHECK_THROWS_WITH(plan(), ContainsSubstring("plan.json: tests[0].log: expected a log other than the "
                                                "training's, of which training uses all rows"));
    content["training"]["rows"] = 200;
    content["tests"][0] = {{"log", "./train.csv"}, {"first", 199}, {"rows", 50}};
    CHECK_THROWS_WITH(plan(), ContainsSubstring("plan.json: tests[0].first: expected a row from 200 on"));
    content["tests"][0]["first"] = 200;
    CHECK(load_plan_data(plan()).subsets.front().time_s.front() == Approx(10));
}

TEST_CASE("a quick plan has the same cases and claims with less effort") {
    json content = small_plan();
    content["training"]["start_rows"] = 1000;
    content["training"]["rows"] = 9000;
    content["tests"][0]["rows"] = 2000;
    content["defaults"]["features"] = 500;
    content["defaults"]["starts"] = 6;
    content["comparisons"] = {{{"better", "NP-ML-DFR"}, {"worse", "NP-ML-STD"}, {"phase", "steady"}}};
    const Plan plan = plan_of(content);
    const Plan quick = quick_plan(plan);
    CHECK(case_names(quick) == case_names(plan));
    CHECK(quick.comparisons.size() == plan.comparisons.size());
    CHECK(quick.seeds == std::vector<std::uint64_t>{1});
    CHECK(quick.start_rows == 400);
    CHECK(quick.most_online_rows == 400);
    CHECK(quick.tests.front().rows == 400);
    CHECK(quick.cases.front().feature_count == 30);
    CHECK(quick.cases.front().starts == 1);
    CHECK(quick.cases.front().lags == plan.cases.front().lags);
}

TEST_CASE("a plan takes missing fields from the plan that it is based on") {
    const TemporaryDirectory directory;
    directory.write("base.json", small_plan().dump());
    const auto like_base = [&directory](const std::string& fields) {
        std::string text = "{\"like\": \"base.json\", ";
        return read_plan(directory.write("plan.json", text.append(fields).append("}")));
    };
    const Plan plan = like_base(R"("name": "other", "defaults": {"features": 20})");
    CHECK(plan.name == "other");
    CHECK(plan.title == "A small experiment");
    CHECK(plan.cases.size() == 2);
    CHECK(plan.cases[0].feature_count == 20);
    CHECK(plan.cases[0].lags == 10); // "defaults" is replaced as a whole
    CHECK_THROWS_AS(like_base(R"("nmae": "other")"), InputError);
    CHECK_THROWS_AS(read_plan(directory.write("plan.json", R"({"like": "none.json"})")), InputError);
}

TEST_CASE("the plans of tools/reproduce.sh are valid and have the same findings for both robots") {
    const std::filesystem::path folder = DFDYN_TEST_DATA_DIR "/../../tools/experiment/plans";
    const Plan icub = read_plan(folder / "icub.json");
    const Plan ur5 = read_plan(folder / "ur5.json");
    constexpr std::size_t of_the_paper = 12;
    for (std::size_t i = 0; i < of_the_paper; ++i) {
        CHECK(icub.findings[i].name == ur5.findings[i].name);
        CHECK(icub.findings[i].comparisons.size() == ur5.findings[i].comparisons.size());
    }
    CHECK(icub.findings.size() > of_the_paper);
    CHECK(ur5.findings.size() > of_the_paper);
    CHECK(icub.seeds.size() >= 10);
    CHECK(ur5.seeds.size() >= 10);
    CHECK(load_plan_data(ur5).subsets.size() == 2);
}

} // namespace plan_test
