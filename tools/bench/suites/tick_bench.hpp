// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/peers/bench_learner.hpp"
#include "tools/bench/timing/machine_lower_bound.hpp"

#include <functional>

namespace dfdyn::tools {

/// Result of one learner at one size.
struct TickResult {
    std::string learner, scalar;
    BenchLearner::Kind kind = BenchLearner::Kind::other;
    int columns = 0;
    double error = 0; ///< of its predictions after some ticks, relative to the batch solution and its rms
    bool right = false;
    TickTimes times; ///< empty for a wrong learner
};

struct LowerBoundResult {
    std::string scalar;
    int columns = 0;
    MachineLowerBound floor;
};

struct TickBench {
    std::vector<TickResult> ticks;
    std::vector<LowerBoundResult> floors;
};

/// Largest error after `verified_ticks`. A learner with a larger error counts as wrong, independently of its
/// speed.
double tolerated_error(const std::string& scalar);
constexpr int verified_ticks = 300;

/// Measures all learners of these sizes and the machine's lower bounds in alternation; peers up to the size
/// `largest_peer`.
TickBench run_tick_bench(const std::vector<int>& columns, int largest_peer, const RepetitionOptions& options,
                         MultiplyAddProbe& probe, const std::function<void(double)>& on_share_done);

/// Returns the result of dfdyn's learner of this size; nullptr if there is none.
const TickResult* find_ours(const TickBench& bench, const std::string& scalar, int columns);
const LowerBoundResult* find_lower_bound(const TickBench& bench, const std::string& scalar, int columns);

/// Returns the fastest correct peer of this size: of one kind, or of all.
const TickResult* fastest_peer(const TickBench& bench, const std::string& scalar, int columns);
const TickResult* fastest_of(const TickBench& bench, BenchLearner::Kind kind, const std::string& scalar,
                             int columns);

} // namespace dfdyn::tools
