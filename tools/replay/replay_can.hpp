// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/arm/bus_sampler.hpp"
#include "tools/replay/replay.hpp"

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>

namespace dfdyn::tools {

/// Statistics of the bus traffic, in addition to the samples.
struct BusFigures {
    std::uint64_t frames = 0;
    hal::BusCounters counters;
    hal::UnexpectedFrames unknown;  ///< frames with identifiers that no device of the description has
    hal::UnexpectedFrames rejected; ///< frames with known identifiers and invalid content
    std::uint64_t strays = 0;       ///< frames that were left out because their stamps were ahead
    std::uint64_t late_moments = 0; ///< triggers that came too late for a sample
};

struct ReplayedBus {
    ReplayedRecording replayed; ///< `time_s`: since the first frame
    BusFigures bus;
};

/// Runs an estimator over the samples from a stream of frames.
class CanReplayer {
  public:
    /// Throws InputError if joints, outputs or rate of the description differ from those of the models, or if
    /// a model needs measured derivatives. Keeps references to the estimator.
    CanReplayer(RuntimeEstimator& estimator, std::span<const TrainedModel> models,
                const BusDescription& description, std::string source, std::size_t horizon,
                const ReplayMemory& memory = {});
    CanReplayer(const CanReplayer&) = delete;
    CanReplayer& operator=(const CanReplayer&) = delete;

    BusSampler& sampler() noexcept { return sampler_; }

    /// Returns all results; call once, at the end.
    ReplayedBus finish(const hal::BusCounters& counters);

  private:
    void tick(const BusSample& sample);

    Replayer replayer_;
    BusSampler sampler_;
};

/// Runs `estimator` over a candump log, with the log's time stamps. `log_interface`: the interface whose
/// frames are used if the log has several. Throws InputError for a log that is malformed or without frames,
/// and as CanReplayer.
ReplayedBus replay_log(RuntimeEstimator& estimator, std::span<const TrainedModel> models,
                       const BusDescription& description, const std::filesystem::path& log,
                       const std::string& log_interface, std::size_t horizon);

/// Prints the statistics of the bus, after those of the replay.
void print_bus(std::ostream& out, const BusFigures& figures);

} // namespace dfdyn::tools
