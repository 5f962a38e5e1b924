// SPDX-License-Identifier: Apache-2.0
// A run of all benchmarks with few repetitions, and its output. No times are checked.
#include "tools/bench/bench.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"
#include "tests/tools/support/balanced_markup.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>

using namespace dfdyn::tools;
using dfdyn::tests::markup_fault;
using dfdyn::tests::Outcome;
using dfdyn::tests::run_program;
using dfdyn::tests::TemporaryDirectory;
using nlohmann::json;

namespace {

bool has_all(const json& object, const std::vector<std::string>& keys) {
    return std::ranges::all_of(keys, [&](const std::string& key) { return object.contains(key); });
}

const std::vector<std::string> time_keys{"median_us", "p90_us", "p99_us", "p999_us",
                                         "max_us",    "spread", "ticks",  "undisturbed"};

BenchTarget only_target(double measured, bool at_most) { return {"x", measured, 2, at_most}; }

} // namespace

TEST_CASE("a quick run measures everything and its JSON has the fields of the schema") {
    const TemporaryDirectory directory;
    const std::string folder = (directory.path() / "out").string();
    const Outcome outcome = run_program(directory, "bench --quick --hour -o " + folder);
    CAPTURE(outcome.error);
    CHECK(outcome.status == 0);
    const json all = json::parse(dfdyn::tests::file_content(folder + "/bench.json"));
    CHECK(all["schema"] == "dfdyn.bench/1");
    CHECK(has_all(all, {"machine", "ticks", "floors", "growth_exponent", "models", "endurance", "memory",
                        "targets", "missing", "replay"}));
    CHECK(has_all(all["machine"], {"processor", "clock", "clock_cost_ns", "build", "optimised",
                                   "vector_multiply_adds_per_ns"}));
    REQUIRE(all["ticks"].size() >= 6);
    for (const json& tick : all["ticks"]) {
        CAPTURE(tick.dump());
        CHECK(has_all(tick, {"learner", "scalar", "columns", "error", "right"}));
        CHECK(tick["right"] == true);
        CHECK(has_all(tick, time_keys));
        CHECK(tick["ticks"] > 0);
    }
    REQUIRE(all["floors"].size() == 2);
    CHECK(has_all(all["floors"][0], {"scalar", "columns", "arithmetic_us", "memory_us"}));
    for (const std::string part : {"nonparametric", "features", "kernel", "dense"}) {
        CHECK(has_all(all["models"][part], time_keys));
    }
    CHECK(all["endurance"]["ticks_per_stretch"] == 1000);
    CHECK(all["replay"]["rows"] == 2000);
    CHECK(all["replay"]["learned"] > 1900);
    CHECK(all["memory"].size() == 8);
    CHECK_FALSE(all["targets"].empty());
    CHECK_THAT(outcome.out, Catch::Matchers::ContainsSubstring("| times faster than the fastest peer"));
    CHECK(dfdyn::tests::file_content(folder + "/bench.md") == outcome.out);
    CHECK(markup_fault(dfdyn::tests::file_content(folder + "/pictures/tick-time.svg")).empty());
}

TEST_CASE("a target includes its limit and has a direction") {
    CHECK(only_target(2, true).met());
    CHECK(only_target(1.9, true).met());
    CHECK_FALSE(only_target(2.1, true).met());
    CHECK(only_target(2, false).met());
    CHECK(only_target(2.1, false).met());
    CHECK_FALSE(only_target(1.9, false).met());
}

TEST_CASE("a wrong learner is shown without a time and is not compared") {
    BenchResults results;
    results.ticks.ticks = {{"dfdyn", "float", BenchLearner::Kind::ours, 100, 1e-6, true, {}},
                           {"quick and wrong", "float", BenchLearner::Kind::covariance, 100, 0.5, false, {}},
                           {"slow", "float", BenchLearner::Kind::cholesky, 100, 1e-5, true, {}},
                           {"the paper's", "double", BenchLearner::Kind::gurls, 100, 1e-12, true, {}},
                           {"dfdyn", "double", BenchLearner::Kind::ours, 100, 1e-12, true, {}}};
    results.ticks.ticks[0].times.median = 1;
    results.ticks.ticks[1].times.median = 0.1;
    results.ticks.ticks[2].times.median = 9;
    results.ticks.ticks[3].times.median = 40;
    results.ticks.ticks[4].times.median = 2;
    results.ticks.floors = {{"float", 100, {0.5, 0.25}}, {"double", 100, {1, 0.5}}};
    const json all = bench_json(results);
    CHECK_FALSE(all["ticks"][1].contains("median_us"));
    const std::vector<BenchTarget> targets = bench_targets(results);
    REQUIRE(targets.size() >= 3);
    CHECK(targets[0].measured == Approx(9)); // the fastest of those that are correct
    CHECK(targets[1].measured == Approx(9));
    CHECK(targets[2].measured == Approx(20)); // the same precision
    CHECK(targets[2].limit == 30);
    CHECK_THAT(figure_page_markdown(bench_page(results)), Catch::Matchers::ContainsSubstring("0.5, wrong"));
}

TEST_CASE("the growth exponent is fitted from 200 columns on") {
    TickBench bench;
    for (const int columns : {100, 200, 400, 800}) {
        TickResult one{"dfdyn", "float", BenchLearner::Kind::ours, columns, 0, true, {}};
        one.times.median = columns == 100 ? 1e6 : 1e-4 * columns * columns;
        bench.ticks.push_back(one);
        bench.floors.push_back({"float", columns, {}});
    }
    CHECK(growth_exponent(bench) == Approx(2));
    bench.floors.resize(2);
    CHECK(growth_exponent(bench) == 0);
}
