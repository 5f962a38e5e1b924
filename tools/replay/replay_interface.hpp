// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/replay/replay_can.hpp"

#include <atomic>

namespace dfdyn::tools {

struct InterfaceOptions {
    std::string interface;
    double duration_s = 0;        ///< 0: until stopped
    std::filesystem::path record; ///< log of the received frames; empty: none
    ReplayMemory memory = {};
};

/// Runs `estimator` over the frames of a CAN interface in real time, until `stop` becomes true. The log and
/// the output of `options.memory.sink` are written continuously and flushed four times a second. The function
/// sleeps while no frame arrives. It requests the sensors' full scales while these are missing or uncertain.
/// `replay_log` of the recorded log gives identical ticks, bit for bit, up to the last frame. Throws
/// InputError if the interface cannot be opened or no frame was received, and as CanReplayer.
ReplayedBus replay_interface(RuntimeEstimator& estimator, std::span<const TrainedModel> models,
                             const BusDescription& description, const InterfaceOptions& options,
                             std::size_t horizon, const std::atomic<bool>& stop);

} // namespace dfdyn::tools
