// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/atomic_file.hpp"
#include "tools/base/system/progress.hpp"
#include "tools/bench/bench.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/value_checks.hpp"

#include <algorithm>
#include <iostream>
#include <memory>

namespace dfdyn::tools {

namespace {

constexpr std::size_t rows_of_an_hour = 3'600'000;

struct BenchCommandOptions {
    BenchOptions bench;
    std::filesystem::path folder;
    bool hour = false;
    bool quick = false;
    bool json = false;
};

/// Runs every part briefly, as a functional test without meaningful times.
BenchOptions quick_options(BenchOptions options) {
    options.columns = {100};
    options.repetitions.passes = 3;
    options.repetitions.repetition_us = 50;
    options.dense_ticks = 2;
    options.small_models = true;
    options.stretch_ticks = 1000;
    return options;
}

bool all_of_ours_right(const TickBench& bench) {
    return std::ranges::all_of(
        bench.ticks, [](const TickResult& one) { return one.kind != BenchLearner::Kind::ours || one.right; });
}

int run(const BenchCommandOptions& options) {
    const JsonOutput output(options.json);
    BenchOptions bench = options.quick ? quick_options(options.bench) : options.bench;
    if (options.hour) {
        bench.replay_rows = options.quick ? 2000 : rows_of_an_hour;
    }
    if (!is_optimised()) {
        std::cerr << "dfdyn bench: this program was built without optimisation: its times are meaningless\n";
    }
    if (!options.folder.empty()) {
        check_folder(options.folder);
    }
    BenchResults results;
    {
        Progress progress("measuring, %", 100);
        results = run_bench(bench, [&](double share) { progress.update_part(100 * share); });
    }
    if (!options.folder.empty()) {
        write_bench(options.folder, results);
    }
    output.print(bench_json(results));
    std::cout << figure_page_markdown(bench_page(results));
    return all_of_ours_right(results.ticks) ? 0 : 1;
}

} // namespace

void add_bench_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<BenchCommandOptions>();
    CLI::App* command = app.add_subcommand(
        "bench",
        "Measures the time of a tick; compares it with other learners and with the limits of this machine");
    command
        ->add_option("-o,--output", options->folder,
                     "Folder for bench.json, bench.md and pictures/tick-time.svg")
        ->type_name("DIR");
    command
        ->add_option("--passes", options->bench.repetitions.passes,
                     "Repetitions of each learner, in turn with the others; use more on a busy machine")
        ->check(whole_number_in(1, 100'000))
        ->capture_default_str();
    command
        ->add_option("--stretch", options->bench.stretch_ticks,
                     "Ticks in each tenth of the long run; 3600000 are an hour at 1 kHz")
        ->check(whole_number_in(1, 100'000'000))
        ->capture_default_str();
    command->add_flag("--hour", options->hour,
                      "Also replay a generated recording of one hour at 1 kHz (needs 1 GB of memory and 0.9 "
                      "GB for temporary files)");
    command
        ->add_option("--loop", options->bench.loop_s,
                     "Also tick once per millisecond for this many seconds, with a load on another core")
        ->check(number_in(1.0, 3600.0));
    command->add_flag("--quick", options->quick,
                      "Few and short measurements: a functional test without meaningful times");
    add_json_option(*command, options->json);
    command->footer("Example:\n  dfdyn bench --output bench --hour\n"
                    "Learners with wrong predictions are listed without a time.\n"
                    "Exit status: 0 done, whether or not targets are met, 1 dfdyn's own predictions are "
                    "wrong, 2 bad usage.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
