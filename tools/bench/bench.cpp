// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench.hpp"

#include <cmath>

namespace dfdyn::tools {

namespace {

std::string at_columns(const std::string& what, int columns) {
    return what + ", " + std::to_string(columns) + " columns";
}

void append_size(std::vector<BenchTarget>& targets, const TickBench& bench, int columns) {
    const TickResult* ours = find_ours(bench, "float", columns);
    const TickResult* fastest = fastest_peer(bench, "float", columns);
    const TickResult* cholesky = fastest_of(bench, BenchLearner::Kind::cholesky, "float", columns);
    if (ours == nullptr || fastest == nullptr || cholesky == nullptr) {
        return;
    }
    targets.push_back({at_columns("times faster than the fastest peer (" + fastest->learner + ")", columns),
                       fastest->times.median / ours->times.median, 2, false});
    targets.push_back({at_columns("times faster than Eigen's Cholesky route", columns),
                       cholesky->times.median / ours->times.median, 8, false});
    const TickResult* gurls = fastest_of(bench, BenchLearner::Kind::gurls, "double", columns);
    const TickResult* ours_in_double = find_ours(bench, "double", columns);
    if (gurls != nullptr && ours_in_double != nullptr) {
        targets.push_back({at_columns("times faster than " + gurls->learner + ", both in double", columns),
                           gurls->times.median / ours_in_double->times.median, 30, false});
    }
}

void append_floor(std::vector<BenchTarget>& targets, const TickBench& bench) {
    constexpr int columns = 500;
    const TickResult* ours = find_ours(bench, "float", columns);
    const LowerBoundResult* floor = find_lower_bound(bench, "float", columns);
    if (ours != nullptr && floor != nullptr) {
        targets.push_back({at_columns("ratio to the machine's lower bound", columns),
                           ours->times.median / floor->floor.total(), 1.8, true});
    }
}

} // namespace

BenchResults run_bench(const BenchOptions& options, const std::function<void(double)>& on_share_done) {
    BenchResults results;
    MultiplyAddProbe probe;
    results.machine = machine_facts();
    results.ticks = run_tick_bench(options.columns, options.largest_peer, options.repetitions, probe,
                                   [&](double share) { on_share_done(0.5 * share); });
    const auto on_models = [&](double share) { on_share_done(0.5 + 0.2 * share); };
    results.models = options.small_models
                         ? run_small_model_bench(options.repetitions, options.dense_ticks, probe)
                         : run_model_bench(options.repetitions, options.dense_ticks, probe, on_models);
    results.endurance = run_endurance_bench(options.stretch_ticks, options.repetitions, probe,
                                            [&](double share) { on_share_done(0.7 + 0.2 * share); });
    if (options.replay_rows > 0) {
        results.hour =
            run_hour_bench(options.replay_rows, [&](double share) { on_share_done(0.9 + 0.1 * share); });
    }
    if (options.loop_s > 0) {
        results.loop = run_loop_bench(options.loop_s);
    }
    results.vectors_per_ns = probe.best();
    return results;
}

double growth_exponent(const TickBench& bench) {
    std::vector<double> sizes;
    std::vector<double> times;
    for (const LowerBoundResult& floor : bench.floors) {
        const TickResult* ours = find_ours(bench, "float", floor.columns);
        if (floor.scalar == "float" && floor.columns >= 200 && ours != nullptr && ours->times.median > 0) {
            sizes.push_back(floor.columns);
            times.push_back(ours->times.median);
        }
    }
    return sizes.size() < 2 ? 0 : fitted_exponent(sizes, times);
}

std::vector<BenchTarget> bench_targets(const BenchResults& results) {
    std::vector<BenchTarget> targets;
    for (const LowerBoundResult& floor : results.ticks.floors) {
        if (floor.scalar == "float") {
            append_size(targets, results.ticks, floor.columns);
        }
    }
    append_floor(targets, results.ticks);
    if (const double exponent = growth_exponent(results.ticks); exponent > 0) {
        targets.push_back({"exponent of the time from 200 columns on", exponent, 2.1, true});
    }
    const ModelBench& models = results.models;
    targets.push_back({"random features' share of the tick, %", 100 * models.feature_share(), 15, true});
    targets.push_back({"SPK's tick relative to NP's", models.kernel_over_nonparametric(), 8, true});
    targets.push_back({"times faster than SPK's dense form", models.dense_over_kernel(), 20, false});
    const EnduranceBench& endurance = results.endurance;
    targets.push_back({"change after ten times as many ticks, moving, %",
                       100 * std::abs(endurance.change_moving()), 2, true});
    targets.push_back({"change after ten times as many ticks, standing, %",
                       100 * std::abs(endurance.change_standing()), 2, true});
    if (results.loop) {
        targets.push_back({"deadlines missed by the loop, of " + std::to_string(results.loop->pace.ticks),
                           static_cast<double>(results.loop->pace.missed), 0, true});
    }
    if (results.hour) {
        targets.push_back(
            {"times real time, replay of a recording", results.hour->times_real_time(), 100, false});
    }
    return targets;
}

} // namespace dfdyn::tools
