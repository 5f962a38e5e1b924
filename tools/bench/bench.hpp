// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/suites/endurance_bench.hpp"
#include "tools/bench/suites/hour_bench.hpp"
#include "tools/bench/suites/loop_bench.hpp"
#include "tools/bench/suites/model_bench.hpp"
#include "tools/bench/suites/tick_bench.hpp"
#include "tools/bench/timing/machine.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

struct BenchOptions {
    std::vector<int> columns = contender_columns();
    int largest_peer = 1000; ///< sizes beyond are measured without peers
    RepetitionOptions repetitions;
    int dense_ticks = 5;                  ///< of SPK's dense form, whose ticks are long
    bool small_models = false;            ///< few columns in the part about SPK
    std::int64_t stretch_ticks = 200'000; ///< a tenth of a learner's life in the part about endurance
    std::size_t replay_rows = 0;          ///< 0: nothing is replayed
    double loop_s = 0;                    ///< of the periodic loop; 0: none
};

/// All that a run of `dfdyn bench` found.
struct BenchResults {
    MachineFacts machine;
    double vectors_per_ns = 0; ///< multiply-adds of the probe at its best
    TickBench ticks;
    ModelBench models;
    EnduranceBench endurance;
    std::optional<HourBench> hour;
    std::optional<LoopBench> loop;
};

BenchResults run_bench(const BenchOptions& options, const std::function<void(double)>& on_share_done);

/// What is wanted of a figure.
struct BenchTarget {
    std::string name;
    double measured = 0;
    double limit = 0;
    bool at_most = true; ///< otherwise at least

    bool met() const { return at_most ? measured <= limit : measured >= limit; }
};

/// Of what was measured.
std::vector<BenchTarget> bench_targets(const BenchResults& results);

/// The exponent of our time in float over the sizes of 200 columns and more; 0 if these are fewer than two.
double growth_exponent(const TickBench& bench);

} // namespace dfdyn::tools
