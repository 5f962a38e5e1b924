// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/number.hpp"
#include "tools/bench/bench.hpp"
#include "tools/bench/memory_table.hpp"
#include "tools/report/chart.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

const std::vector<std::string> time_columns{"median", "p90",       "p99",   "p99.9",
                                            "max",    "spread, %", "ticks", "undisturbed, %"};

void append_times(std::vector<ReportCell>& row, const TickTimes& times) {
    const std::vector<ReportCell> cells{times.median,
                                        times.p90,
                                        times.p99,
                                        times.p999,
                                        times.most,
                                        100 * times.spread,
                                        static_cast<double>(times.ticks),
                                        100 * times.accepted};
    row.insert(row.end(), cells.begin(), cells.end());
}

std::vector<std::string> with_times(std::vector<std::string> columns) {
    columns.insert(columns.end(), time_columns.begin(), time_columns.end());
    return columns;
}

/// Formats with three digits, independent of the other values in its column.
std::string as_text(double value) { return value < 1000 ? rounded_text(value) : formatted("%.0f", value); }

ReportTable target_table(const std::vector<BenchTarget>& targets) {
    ReportTable table{"Targets", {"what", "wanted", "measured", ""}, {}, ""};
    for (const BenchTarget& target : targets) {
        table.rows.push_back({target.name,
                              std::string(target.at_most ? "at most " : "at least ") + as_text(target.limit),
                              as_text(target.measured), std::string(target.met() ? "met" : "not met")});
    }
    return table;
}

/// Table of medians: one row per learner, one column per size.
ReportTable overview(const BenchResults& results, const std::string& scalar) {
    ReportTable table{"One tick in " + scalar + ", median in µs", {"learner"}, {}, ""};
    std::vector<int> sizes;
    for (const LowerBoundResult& floor : results.ticks.floors) {
        if (floor.scalar == scalar) {
            sizes.push_back(floor.columns);
            table.columns.push_back("2d = " + std::to_string(floor.columns));
        }
    }
    const auto add_row = [&](const std::string& name, const auto& value_of) {
        std::vector<ReportCell> row{name};
        for (const int columns : sizes) {
            const double value = value_of(columns);
            row.emplace_back(value > 0 ? as_text(value) : "–");
        }
        table.rows.push_back(std::move(row));
    };
    std::vector<std::string> names;
    for (const TickResult& one : results.ticks.ticks) {
        if (one.scalar == scalar && std::ranges::find(names, one.learner) == names.end()) {
            names.push_back(one.learner);
        }
    }
    for (const std::string& name : names) {
        add_row(name, [&](int columns) {
            const auto found = std::ranges::find_if(results.ticks.ticks, [&](const TickResult& one) {
                return one.scalar == scalar && one.learner == name && one.columns == columns;
            });
            return found == results.ticks.ticks.end() ? 0 : found->times.median;
        });
    }
    const auto floor_of = [&](int columns) {
        return find_lower_bound(results.ticks, scalar, columns)->floor;
    };
    add_row("lower bound: 1.5 p² multiply-adds", [&](int columns) { return floor_of(columns).arithmetic; });
    add_row("lower bound: the triangle read and written",
            [&](int columns) { return floor_of(columns).memory; });
    add_row("dfdyn over the larger lower bound", [&](int columns) {
        const TickResult* ours = find_ours(results.ticks, scalar, columns);
        return ours == nullptr ? 0 : ours->times.median / floor_of(columns).total();
    });
    return table;
}

ReportTable tick_table(const BenchResults& results) {
    ReportTable table{"Each in detail, µs", with_times({"learner", "scalar", "2d", "error"}), {}, ""};
    for (const TickResult& one : results.ticks.ticks) {
        std::vector<ReportCell> row{one.learner, one.scalar, static_cast<double>(one.columns),
                                    rounded_text(one.error) + (one.right ? "" : ", wrong")};
        append_times(row, one.times);
        table.rows.push_back(std::move(row));
    }
    table.note =
        "error: largest difference of the predictions after " + std::to_string(verified_ticks) +
        " ticks from the batch solution in double, relative to their rms; a learner with more than " +
        rounded_text(tolerated_error("float")) + " in float or " + rounded_text(tolerated_error("double")) +
        " in double counts as wrong, and its time is not shown. spread: interquartile range over the median. "
        "undisturbed: share of the valid repetitions; below 10, all repetitions are used.";
    return table;
}

ReportTable model_table(const ModelBench& models, const EnduranceBench& endurance) {
    ReportTable table{"Other parts and long runs, µs, float", with_times({"what"}), {}, ""};
    const auto add = [&](const std::string& name, const TickTimes& times) {
        std::vector<ReportCell> row{name};
        append_times(row, times);
        table.rows.push_back(std::move(row));
    };
    const std::string columns = std::to_string(models.columns) + " columns";
    add("NP, " + columns, models.nonparametric);
    add("random features, " + columns + " of " + std::to_string(models.inputs) + " inputs", models.features);
    add("SPK, " + columns + ", p = " + std::to_string(models.physical_parameters), models.kernel);
    add("SPK by one Cholesky factor of all unknowns", models.dense);
    const std::string size = ", " + std::to_string(EnduranceBench::columns) + " columns, ";
    add("moving" + size + "after the first stretch", endurance.first_moving);
    add("moving" + size + "after the last stretch", endurance.last_moving);
    add("standing" + size + "after the first stretch", endurance.first_standing);
    add("standing" + size + "after the last stretch", endurance.last_standing);
    return table;
}

/// Growth of the time from each size to the next, as text.
std::string growth_words(const TickBench& bench) {
    std::string words;
    const TickResult* before = nullptr;
    for (const LowerBoundResult& floor : bench.floors) {
        const TickResult* ours = floor.scalar == "float" ? find_ours(bench, "float", floor.columns) : nullptr;
        if (ours != nullptr && before != nullptr) {
            const double sizes[] = {static_cast<double>(before->columns), static_cast<double>(ours->columns)};
            const double times[] = {before->times.median, ours->times.median};
            words += (words.empty() ? " (" : ", ") + std::to_string(before->columns) + " to " +
                     std::to_string(ours->columns) + ": " + rounded_text(fitted_exponent(sizes, times));
        }
        before = ours != nullptr ? ours : before;
    }
    return words.empty() ? words : words + ")";
}

std::string model_words(const ModelBench& models) {
    return "Random features: " + rounded_text(100 * models.feature_share()) +
           " % of a tick of NP. SPK: " + rounded_text(models.kernel_over_nonparametric()) +
           " ticks of NP, and its predictions differ from the dense form's in double by " +
           rounded_text(models.kernel_error) + " of their rms.";
}

std::string endurance_words(const EnduranceBench& endurance) {
    return "Long runs: ten stretches of " + std::to_string(endurance.ticks) +
           " ticks each with forgetting, nine tenths of each at standstill. The states after the first and "
           "the tenth stretch then tick in turn. The 90th percentile is compared: it is a tick that bounds "
           "a variance. These ticks take longer, and their number depends on the motion. Moving: " +
           formatted("%+.1f %%", 100 * endurance.change_moving()) +
           ", standing: " + formatted("%+.1f %%", 100 * endurance.change_standing()) +
           "; denormal numbers in the last state: " + std::to_string(endurance.denormals) + ".";
}

std::string hour_words(const HourBench& hour) {
    return "Replay, times on one core: " + std::to_string(hour.rows) +
           " rows at 1 kHz, six joints, six outputs, model NP with 200 columns: read from CSV in " +
           rounded_text(hour.read_s) + " s, replayed in " + rounded_text(hour.replay_s) + " s (" +
           rounded_text(hour.ticks_only_s) +
           " s without the index over 25 samples): " + rounded_text(hour.times_real_time()) +
           " times real time.";
}

std::string loop_words(const LoopBench& loop) {
    return "The loop: " + std::to_string(loop.pace.ticks) +
           " ticks at 1 kHz, six joints, six outputs, model NP with 200 columns, " +
           std::to_string(loop.learned) +
           " samples learned, each in its tick (the first ones fill the window). Another thread works on "
           "64 MiB" +
           (loop.cores > 1 ? " on another core" : ", on the only core") +
           ". Deadlines missed: " + std::to_string(loop.pace.missed) + ". " +
           (loop.not_real_time.empty()
                ? "SCHED_FIFO and locked memory were granted."
                : "Not granted, so the timing is that of an ordinary program: " + loop.not_real_time + ".");
}

ReportTable loop_table(const LoopBench& loop) {
    ReportTable table{"The loop, µs", {"what", "median", "p99", "p99.9", "p99.99", "max"}, {}, ""};
    const auto add = [&](const std::string& name, const TickTimes& times) {
        table.rows.push_back({name, times.median, times.p99, times.p999, times.p9999, times.most});
    };
    add("from when a tick is due until it begins (jitter)", loop.late);
    add("the estimator's tick", loop.duration);
    return table;
}

ReportTable memory_table() {
    ReportTable table{"Bytes of the estimator on this machine, model NP, six joints and outputs",
                      {"scalar", "2d", "state", "constants"},
                      {},
                      ""};
    for (const MemoryRow& row : memory_rows()) {
        table.rows.push_back({row.scalar, static_cast<double>(row.columns),
                              static_cast<double>(row.bytes.state_bytes),
                              static_cast<double>(row.bytes.constant_bytes)});
    }
    return table;
}

/// Chart of the float times over size, with the machine's lower bound.
PageChart time_chart(const TickBench& bench) {
    std::vector<ChartCurve> curves;
    const auto add = [&](const std::string& name, double x, double y) {
        auto curve = std::ranges::find(curves, name, &ChartCurve::name);
        if (curve == curves.end()) {
            curve = curves.insert(curves.end(), ChartCurve{name, {}, {}, {}, {}});
        }
        for (auto* values : {&curve->y, &curve->low, &curve->high}) {
            values->push_back(y);
        }
        curve->x.push_back(x);
    };
    for (const TickResult& one : bench.ticks) {
        if (one.scalar == "float" && one.right) {
            add(one.learner, one.columns, one.times.median);
        }
    }
    for (const LowerBoundResult& one : bench.floors) {
        if (one.scalar == "float") {
            add("the machine's lower bound", one.columns, one.floor.total());
        }
    }
    const std::string title = "Time of one tick in float, six outputs";
    return {"tick-time", title, curve_chart(title, "columns 2d", "median, µs", curves)};
}

} // namespace

FigurePage bench_page(const BenchResults& results) {
    FigurePage page;
    page.title = "On the host";
    page.summary = "One tick predicts six outputs for a row of 2d columns, learns the row and computes the "
                   "next weights, on one core and without forgetting (with forgetting: the long runs "
                   "below). All learners alternate within one run, so that other load of the machine "
                   "affects all equally. A repetition is valid if the system did not interrupt it and a "
                   "probe of the processor's speed before and after it reached 97 % of its best.";
    if (!results.machine.optimised) {
        page.summary = "THIS PROGRAM IS NOT OPTIMISED: its times mean nothing. " + page.summary;
    }
    page.sections.push_back({"Targets", {}, {}, {target_table(bench_targets(results))}});
    PageSection ticks{"One tick against other learners", {}, {time_chart(results.ticks)}, {}};
    ticks.paragraphs = missing_peers();
    ticks.tables = {overview(results, "float"), overview(results, "double"), tick_table(results)};
    ticks.paragraphs.push_back(
        "The probe's best: " + rounded_text(results.vectors_per_ns) +
        " vector multiply-adds per ns. Our time in float grows with the columns to the power of " +
        rounded_text(growth_exponent(results.ticks)) + " from 200 on" + growth_words(results.ticks) +
        ". BLAS: " + blas_name() + ".");
    page.sections.push_back(std::move(ticks));
    PageSection rest{"The rest of a tick, long runs, memory",
                     {model_words(results.models), endurance_words(results.endurance)},
                     {},
                     {model_table(results.models, results.endurance), memory_table()}};
    if (results.hour) {
        rest.paragraphs.push_back(hour_words(*results.hour));
    }
    if (results.loop) {
        rest.paragraphs.push_back(loop_words(*results.loop));
        rest.tables.push_back(loop_table(*results.loop));
    }
    page.sections.push_back(std::move(rest));
    page.facts = as_report_facts(results.machine);
    return page;
}

} // namespace dfdyn::tools
