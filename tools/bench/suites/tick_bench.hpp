// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/peers/contender.hpp"
#include "tools/bench/timing/floor.hpp"

#include <functional>

namespace dfdyn::tools {

/// What one contender did at one size.
struct TickResult {
    std::string contender, scalar;
    Contender::Kind kind = Contender::Kind::other;
    int columns = 0;
    double error = 0; ///< of its predictions after some ticks, against the batch solution, over their rms
    bool right = false;
    TickTimes times; ///< none of one that is wrong
};

struct FloorResult {
    std::string scalar;
    int columns = 0;
    Floor floor;
};

struct TickBench {
    std::vector<TickResult> ticks;
    std::vector<FloorResult> floors;
};

/// A learner that is off by more than this after `verified_ticks` is wrong, however fast it is.
double tolerated_error(const std::string& scalar);
constexpr int verified_ticks = 300;

/// All contenders of these sizes, and the floors, in turn; peers of the sizes up to `largest_peer`.
TickBench run_tick_bench(const std::vector<int>& columns, int largest_peer, const RepetitionOptions& options,
                         MultiplyAddProbe& probe, const std::function<void(double)>& on_share_done);

/// Our result of that size; nullptr if there is none.
const TickResult* find_ours(const TickBench& bench, const std::string& scalar, int columns);
const FloorResult* find_floor(const TickBench& bench, const std::string& scalar, int columns);

/// The fastest right one of that size: of a kind, or of all peers.
const TickResult* fastest_peer(const TickBench& bench, const std::string& scalar, int columns);
const TickResult* fastest_of(const TickBench& bench, Contender::Kind kind, const std::string& scalar,
                             int columns);

} // namespace dfdyn::tools
