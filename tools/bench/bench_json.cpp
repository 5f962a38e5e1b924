// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/file_set.hpp"
#include "tools/base/text/json_text.hpp"
#include "tools/bench/bench.hpp"
#include "tools/bench/memory_table.hpp"
#include "tools/report/chart.hpp"

#include <nlohmann/json.hpp>

namespace dfdyn::tools {

namespace {

using nlohmann::json;

json times_json(const TickTimes& times) {
    return {{"median_us", times.median}, {"p90_us", times.p90},          {"p99_us", times.p99},
            {"p999_us", times.p999},     {"max_us", times.most},         {"spread", times.spread},
            {"ticks", times.ticks},      {"undisturbed", times.accepted}};
}

json ticks_json(const TickBench& bench) {
    json all = json::array();
    for (const TickResult& one : bench.ticks) {
        json entry{{"learner", one.learner},
                   {"scalar", one.scalar},
                   {"columns", one.columns},
                   {"error", one.error},
                   {"right", one.right}};
        if (one.right) {
            entry.update(times_json(one.times));
        }
        all.push_back(std::move(entry));
    }
    return all;
}

json floors_json(const TickBench& bench) {
    json all = json::array();
    for (const LowerBoundResult& one : bench.floors) {
        all.push_back({{"scalar", one.scalar},
                       {"columns", one.columns},
                       {"arithmetic_us", one.floor.arithmetic},
                       {"memory_us", one.floor.memory}});
    }
    return all;
}

json models_json(const ModelBench& models) {
    return {{"columns", models.columns},
            {"inputs", models.inputs},
            {"physical_parameters", models.physical_parameters},
            {"nonparametric", times_json(models.nonparametric)},
            {"features", times_json(models.features)},
            {"kernel", times_json(models.kernel)},
            {"dense", times_json(models.dense)},
            {"kernel_error", models.kernel_error}};
}

json endurance_json(const EnduranceBench& endurance) {
    return {{"columns", EnduranceBench::columns},
            {"stretches", EnduranceBench::stretches},
            {"ticks_per_stretch", endurance.ticks},
            {"first_moving", times_json(endurance.first_moving)},
            {"last_moving", times_json(endurance.last_moving)},
            {"first_standing", times_json(endurance.first_standing)},
            {"last_standing", times_json(endurance.last_standing)},
            {"denormals", endurance.denormals}};
}

json hour_json(const HourBench& hour) {
    return {{"rows", hour.rows},         {"read_s", hour.read_s},
            {"replay_s", hour.replay_s}, {"ticks_only_s", hour.ticks_only_s},
            {"learned", hour.learned},   {"times_real_time", hour.times_real_time()}};
}

json loop_times_json(const TickTimes& times) {
    return {{"median_us", times.median},
            {"p99_us", times.p99},
            {"p999_us", times.p999},
            {"p9999_us", times.p9999},
            {"max_us", times.most}};
}

json loop_json(const LoopBench& loop) {
    return {{"ticks", loop.pace.ticks},
            {"missed", loop.pace.missed},
            {"learned", loop.learned},
            {"late", loop_times_json(loop.late)},
            {"tick", loop_times_json(loop.duration)},
            {"not_granted", loop.not_real_time},
            {"cores", loop.cores}};
}

json memory_json() {
    json all = json::array();
    for (const MemoryRow& row : memory_rows()) {
        all.push_back({{"scalar", row.scalar},
                       {"columns", row.columns},
                       {"state_bytes", row.bytes.state_bytes},
                       {"constant_bytes", row.bytes.constant_bytes}});
    }
    return all;
}

json targets_json(const std::vector<BenchTarget>& targets) {
    json all = json::array();
    for (const BenchTarget& target : targets) {
        all.push_back({{"name", target.name},
                       {target.at_most ? "at_most" : "at_least", target.limit},
                       {"measured", target.measured},
                       {"met", target.met()}});
    }
    return all;
}

} // namespace

json bench_json(const BenchResults& results) {
    json all{{"schema", "dfdyn.bench/1"},
             {"machine",
              {{"processor", results.machine.processor},
               {"clock", results.machine.clock_source},
               {"clock_cost_ns", results.machine.clock_cost_ns},
               {"build", results.machine.build},
               {"optimised", results.machine.optimised},
               {"vector_multiply_adds_per_ns", results.vectors_per_ns}}},
             {"ticks", ticks_json(results.ticks)},
             {"floors", floors_json(results.ticks)},
             {"growth_exponent", growth_exponent(results.ticks)},
             {"models", models_json(results.models)},
             {"endurance", endurance_json(results.endurance)},
             {"memory", memory_json()},
             {"targets", targets_json(bench_targets(results))},
             {"missing", missing_peers()}};
    if (results.hour) {
        all["replay"] = hour_json(*results.hour);
    }
    if (results.loop) {
        all["loop"] = loop_json(*results.loop);
    }
    return all;
}

void write_bench(const std::filesystem::path& folder, const BenchResults& results) {
    const FigurePage page = bench_page(results);
    FileSet files;
    files.add_folder(folder / "pictures");
    files.add(folder / "bench.json", json_text(bench_json(results)) + '\n');
    files.add(folder / "bench.md", figure_page_markdown(page));
    for (const PageSection& section : page.sections) {
        for (const PageChart& chart : section.charts) {
            files.add(folder / "pictures" / (chart.name + ".svg"), standalone_chart(chart.svg));
        }
    }
    files.commit();
}

} // namespace dfdyn::tools
