// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/suites/tick_bench.hpp"

#include <algorithm>
#include <iterator>

namespace dfdyn::tools {

namespace {

TickResult verify(BenchLearner& learner, const RegressionTask::Matrix& expected, int columns) {
    for (int i = 0; i < verified_ticks; ++i) {
        learner.tick();
    }
    TickResult result{learner.name(), learner.scalar(), learner.kind(), columns, 0, false, {}};
    result.error = relative_error(learner.predictions(), expected);
    result.right = result.error <= tolerated_error(learner.scalar());
    return result;
}

/// Appends the results of one size.
void run_size(TickBench& bench, int columns, bool with_peers, const RepetitionOptions& options,
              MultiplyAddProbe& probe, const std::function<void(double)>& on_share_done) {
    const RegressionTask task(columns);
    BenchLearners learners = dfdyn_learners(task);
    std::vector<std::string> scalars;
    for (const auto& ours : learners) {
        scalars.push_back(ours->scalar());
    }
    if (with_peers) {
        std::ranges::move(peers(task), std::back_inserter(learners));
    }
    const RegressionTask::Matrix expected = task.batch_predictions(verified_ticks);
    std::vector<TickResult> results;
    std::vector<Ticking*> subjects;
    for (const auto& learner : learners) {
        results.push_back(verify(*learner, expected, columns));
        if (results.back().right) {
            subjects.push_back(learner.get());
        }
    }
    std::vector<std::unique_ptr<Ticking>> passes;
    for (const std::string& scalar : scalars) {
        passes.push_back(make_triangle_pass(columns, scalar));
        subjects.push_back(passes.back().get());
    }
    const std::vector<TickTimes> times =
        time_interleaved(subjects, options, probe, clock_cost_ns(),
                         [&](int done) { on_share_done(static_cast<double>(done) / options.passes); });
    auto next = times.begin();
    for (TickResult& result : results) {
        if (result.right) {
            result.times = *next++;
        }
        bench.ticks.push_back(result);
    }
    for (const std::string& scalar : scalars) {
        bench.floors.push_back({scalar, columns, {0, (next++)->median}});
    }
}

} // namespace

double tolerated_error(const std::string& scalar) { return scalar == "float" ? 1e-2 : 1e-8; }

TickBench run_tick_bench(const std::vector<int>& columns, int largest_peer, const RepetitionOptions& options,
                         MultiplyAddProbe& probe, const std::function<void(double)>& on_share_done) {
    TickBench bench;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        run_size(bench, columns[i], columns[i] <= largest_peer, options, probe, [&](double share) {
            on_share_done((static_cast<double>(i) + share) / static_cast<double>(columns.size()));
        });
    }
    for (LowerBoundResult& floor : bench.floors) {
        floor.floor.arithmetic = arithmetic_floor_us(floor.columns, floor.scalar, probe.best());
    }
    return bench;
}

const TickResult* find_ours(const TickBench& bench, const std::string& scalar, int columns) {
    return fastest_of(bench, BenchLearner::Kind::ours, scalar, columns);
}

const LowerBoundResult* find_lower_bound(const TickBench& bench, const std::string& scalar, int columns) {
    const auto found = std::ranges::find_if(bench.floors, [&](const LowerBoundResult& one) {
        return one.scalar == scalar && one.columns == columns;
    });
    return found == bench.floors.end() ? nullptr : &*found;
}

const TickResult* fastest_peer(const TickBench& bench, const std::string& scalar, int columns) {
    const TickResult* fastest = nullptr;
    for (const BenchLearner::Kind kind : {BenchLearner::Kind::covariance, BenchLearner::Kind::cholesky,
                                          BenchLearner::Kind::gurls, BenchLearner::Kind::other}) {
        const TickResult* one = fastest_of(bench, kind, scalar, columns);
        if (one != nullptr && (fastest == nullptr || one->times.median < fastest->times.median)) {
            fastest = one;
        }
    }
    return fastest;
}

const TickResult* fastest_of(const TickBench& bench, BenchLearner::Kind kind, const std::string& scalar,
                             int columns) {
    const TickResult* fastest = nullptr;
    for (const TickResult& one : bench.ticks) {
        const bool asked = one.kind == kind && one.scalar == scalar && one.columns == columns && one.right;
        if (asked && (fastest == nullptr || one.times.median < fastest->times.median)) {
            fastest = &one;
        }
    }
    return fastest;
}

} // namespace dfdyn::tools
