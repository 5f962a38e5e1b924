// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/suites/endurance_bench.hpp"
#include "tools/bench/suites/hour_bench.hpp"
#include "tools/bench/suites/loop_bench.hpp"
#include "tools/bench/suites/model_bench.hpp"
#include "tools/bench/suites/tick_bench.hpp"
#include "tools/bench/timing/machine.hpp"
#include "tools/report/figure_page.hpp"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

struct BenchOptions {
    std::vector<int> columns = learner_columns();
    int largest_peer = 1000; ///< larger sizes are measured without peers
    RepetitionOptions repetitions;
    int dense_ticks = 5;                  ///< of SPK's dense form, which takes long per tick
    bool small_models = false;            ///< few columns in the SPK part
    std::int64_t stretch_ticks = 200'000; ///< a tenth of a learner's life in the endurance part
    std::size_t replay_rows = 0;          ///< 0: no replay
    double loop_s = 0;                    ///< duration of the periodic loop; 0: none
};

/// All results of a run of `dfdyn bench`.
struct BenchResults {
    MachineFacts machine;
    double vectors_per_ns = 0; ///< best multiply-add rate of the probe
    TickBench ticks;
    ModelBench models;
    EnduranceBench endurance;
    std::optional<HourBench> hour;
    std::optional<LoopBench> loop;
};

BenchResults run_bench(const BenchOptions& options, const std::function<void(double)>& on_share_done);

/// Target value of a measured quantity.
struct BenchTarget {
    std::string name;
    double measured = 0;
    double limit = 0;
    bool at_most = true; ///< upper limit; otherwise lower limit

    bool met() const { return at_most ? measured <= limit : measured >= limit; }
};

/// Returns the targets for the measured parts.
std::vector<BenchTarget> bench_targets(const BenchResults& results);

/// Returns the exponent of the float learner's time over the sizes of 200 columns and more; 0 if there are
/// fewer than two.
double growth_exponent(const TickBench& bench);

/// Returns the results as tables, with a chart of time over size.
FigurePage bench_page(const BenchResults& results);

/// Returns the results as numbers, schema `dfdyn.bench/1`.
nlohmann::json bench_json(const BenchResults& results);

/// Writes bench.json, bench.md (the page), and pictures/tick-time.svg into `folder`, which is created.
void write_bench(const std::filesystem::path& folder, const BenchResults& results);

} // namespace dfdyn::tools
