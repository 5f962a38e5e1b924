// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/replay/replay_can.hpp"

#include <atomic>

namespace dfdyn::tools {

struct InterfaceOptions {
    std::string interface;
    double duration_s = 0;        ///< 0: until stopped
    std::filesystem::path record; ///< a log of what was received; empty: none
    ReplayMemory memory = {};
};

/// Runs `estimator` over what a CAN interface receives, in real time, until `stop` becomes true. The log, and
/// what `options.memory.sink` writes, are written as frames come, and flushed four times a second. Sleeps
/// while no frame comes. Asks sensors for their full scales while those are missing or in doubt. `replay_log`
/// of the recorded log gives the same ticks, bit for bit, up to the last frame. Throws InputError where the
/// interface cannot be opened or nothing was received; and as CanReplayer.
ReplayedBus replay_interface(HostEstimator& estimator, std::span<const TrainedModel> models,
                             const BusDescription& description, const InterfaceOptions& options,
                             std::size_t horizon, const std::atomic<bool>& stop);

} // namespace dfdyn::tools
