// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/arm/bus_sampler.hpp"
#include "tools/replay/replay.hpp"

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>

namespace dfdyn::tools {

/// What was on a bus, beside the samples.
struct BusFigures {
    std::uint64_t frames = 0;
    hal::BusCounters counters;
    hal::Offenders unknown;  ///< on identifiers that no device of the description has
    hal::Offenders rejected; ///< on known ones, and not what is sent there
};

struct ReplayedBus {
    ReplayedRecording replayed; ///< `time_s` counts from the first frame
    BusFigures bus;
};

/// Runs an estimator over the samples that a stream of frames gives.
class CanReplayer {
  public:
    /// Throws InputError where joints, outputs or rate of the description are not those of the models, or a
    /// model needs measured derivatives. Keeps references to the estimator.
    CanReplayer(HostEstimator& estimator, std::span<const TrainedModel> models,
                const BusDescription& description, std::string source, std::size_t horizon,
                const ReplayMemory& memory = {});
    CanReplayer(const CanReplayer&) = delete;
    CanReplayer& operator=(const CanReplayer&) = delete;

    BusSampler& sampler() noexcept { return sampler_; }

    /// All of it; call once, last.
    ReplayedBus finish(const hal::BusCounters& counters);

  private:
    void tick(const BusSample& sample);

    Replayer replayer_;
    BusSampler sampler_;
};

/// Runs `estimator` over a candump log, on the log's own clock. `log_interface`: the one whose frames to
/// take, where the log has several. Throws InputError for a log that is malformed, or without frames; and as
/// CanReplayer.
ReplayedBus replay_log(HostEstimator& estimator, std::span<const TrainedModel> models,
                       const BusDescription& description, const std::filesystem::path& log,
                       const std::string& log_interface, std::size_t horizon);

/// Writes the figures of the bus, after those of the replay.
void print_bus(std::ostream& out, const BusFigures& figures);

} // namespace dfdyn::tools
