// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay_interface.hpp"

#include "dfdyn/hal/socketcan_bus.hpp"
#include "tools/base/system/atomic_file.hpp"
#include "tools/base/text/error.hpp"
#include "tools/can/log/frame_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace dfdyn::tools {

namespace {

/// Passes frames from an interface to a sampler and a recorder, with the same stamps.
class Reception {
  public:
    Reception(const InterfaceOptions& options, BusSampler& sampler)
        : options_(options), sampler_(sampler), bus_({.interface = options.interface}),
          end_ns_(options.duration_s > 0 ? bus_.now_ns() + std::llround(1e9 * options.duration_s)
                                         : std::numeric_limits<std::int64_t>::max()) {}

    void run(const std::atomic<bool>& stop) {
        while (!stop && bus_.now_ns() < end_ns_) {
            request();
            if (!take_one()) {
                nothing_came();
            }
            flush();
        }
    }

    const hal::BusCounters& counters() const { return bus_.counters(); }

  private:
    /// Longest usual delay from a frame's stamp to its reception.
    static constexpr std::int64_t delivery_ns = 5'000'000;
    static constexpr std::int64_t request_period_ns = 100'000'000;
    static constexpr std::int64_t flush_period_ns = 250'000'000;
    /// Waiting times while samples become due without frames, and otherwise.
    static constexpr std::int64_t short_wait_ns = 5'000'000;
    static constexpr std::int64_t long_wait_ns = 100'000'000;

    /// Reads a single frame, so that the bus' state belongs to this frame, as in a recording.
    bool take_one() {
        const std::span<const hal::Frame> frames = bus_.drain(room_);
        for (hal::Frame frame : frames) {
            frame.stamp_ns = std::max(frame.stamp_ns, passed_ns_ + 1);
            record(frame);
            dropped_ = bus_.counters().dropped;
            sampler_.take(frame, bus_.state(), bus_.counters());
            silent_from_ns_ = bus_.now_ns() + BusSampler::longest_silence_ns + delivery_ns;
        }
        return !frames.empty();
    }

    /// The log is created with its first frame.
    void record(const hal::Frame& frame) {
        if (options_.record.empty()) {
            return;
        }
        if (!writer_) {
            file_.emplace(options_.record);
            writer_.emplace(file_->stream(), options_.interface);
        }
        writer_->write(frame, bus_.counters().dropped - dropped_);
    }

    /// Processes samples that become due without a frame. A frame that arrives even later receives a later
    /// stamp.
    void nothing_came() {
        const std::int64_t now_ns = bus_.now_ns();
        if (sampler_.started()) {
            passed_ns_ = std::max(passed_ns_, now_ns - delivery_ns);
            sampler_.advance_to(passed_ns_);
        }
        const bool samples_become_due = sampler_.started() && now_ns < silent_from_ns_;
        bus_.wait(std::min(samples_become_due ? short_wait_ns : long_wait_ns, end_ns_ - now_ns));
    }

    void request() {
        if (bus_.now_ns() < next_request_ns_) {
            return;
        }
        next_request_ns_ = bus_.now_ns() + request_period_ns;
        for (const hal::Frame& frame : sampler_.arm().requests()) {
            bus_.send(frame);
        }
    }

    void flush() {
        if (bus_.now_ns() < next_flush_ns_) {
            return;
        }
        next_flush_ns_ = bus_.now_ns() + flush_period_ns;
        if (file_) {
            file_->stream().flush();
        }
        if (options_.memory.sink != nullptr) {
            options_.memory.sink->flush();
        }
    }

    const InterfaceOptions& options_;
    BusSampler& sampler_;
    hal::SocketCanBus bus_;
    std::int64_t end_ns_;
    std::optional<GrowingFile> file_;
    std::optional<FrameWriter> writer_;
    std::array<hal::Frame, 1> room_{};
    std::uint64_t dropped_ = 0;
    std::int64_t passed_ns_ = std::numeric_limits<std::int64_t>::min();
    std::int64_t silent_from_ns_ = 0; ///< after it, no sample becomes due without a frame
    std::int64_t next_request_ns_ = 0;
    std::int64_t next_flush_ns_ = 0;
};

} // namespace

ReplayedBus replay_interface(RuntimeEstimator& estimator, std::span<const TrainedModel> models,
                             const BusDescription& description, const InterfaceOptions& options,
                             std::size_t horizon, const std::atomic<bool>& stop) {
    try {
        CanReplayer replayer(estimator, models, description, options.interface, horizon, options.memory);
        Reception reception(options, replayer.sampler());
        reception.run(stop);
        if (!replayer.sampler().started()) {
            throw InputError(options.interface + ": expected frames, received none");
        }
        return replayer.finish(reception.counters());
    } catch (const hal::BusError& error) {
        throw InputError(error.what());
    }
}

} // namespace dfdyn::tools
