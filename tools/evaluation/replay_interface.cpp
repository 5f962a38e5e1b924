// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/replay_interface.hpp"

#include "dfdyn/hal/socketcan_bus.hpp"
#include "tools/can/frame_recorder.hpp"
#include "tools/common/error.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

namespace dfdyn::tools {

namespace {

/// Hands what an interface receives to a sampler and a recorder, with the same stamps.
class Reception {
  public:
    Reception(const InterfaceOptions& options, BusSampler& sampler)
        : sampler_(sampler), bus_({.interface = options.interface}), end_ns_(end_of(options)) {
        if (!options.record.empty()) {
            recorder_.emplace(options.record, options.interface);
        }
    }

    void run(const std::atomic<bool>& stop) {
        while (!stop && bus_.now_ns() < end_ns_) {
            request();
            if (!take_one()) {
                nothing_came();
            }
        }
        if (recorder_ && sampler_.started()) {
            recorder_->commit();
        }
    }

    const hal::BusCounters& counters() const { return bus_.counters(); }

  private:
    /// A frame reaches us within this after its stamp, nearly always.
    static constexpr std::int64_t delivery_ns = 5'000'000;
    static constexpr std::int64_t request_period_ns = 100'000'000;
    static constexpr std::chrono::microseconds pause{200};

    std::int64_t end_of(const InterfaceOptions& options) const {
        return options.duration_s > 0 ? bus_.now_ns() + std::llround(1e9 * options.duration_s)
                                      : std::numeric_limits<std::int64_t>::max();
    }

    /// One frame at a time, so that the bus' state is that at this frame, as in a recording.
    bool take_one() {
        const std::span<const hal::Frame> frames = bus_.drain(room_);
        for (hal::Frame frame : frames) {
            frame.stamp_ns = std::max(frame.stamp_ns, passed_ns_ + 1);
            if (recorder_) {
                recorder_->write(frame, bus_.counters().dropped - dropped_);
            }
            dropped_ = bus_.counters().dropped;
            sampler_.take(frame, bus_.state(), bus_.counters());
        }
        return !frames.empty();
    }

    /// What the passing time alone makes due. A frame that is even later is given a later stamp.
    void nothing_came() {
        if (sampler_.started()) {
            passed_ns_ = std::max(passed_ns_, bus_.now_ns() - delivery_ns);
            sampler_.advance_to(passed_ns_);
        }
        std::this_thread::sleep_for(pause);
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

    BusSampler& sampler_;
    hal::SocketCanBus bus_;
    std::int64_t end_ns_;
    std::optional<FrameRecorder> recorder_;
    std::array<hal::Frame, 1> room_{};
    std::uint64_t dropped_ = 0;
    std::int64_t passed_ns_ = std::numeric_limits<std::int64_t>::min();
    std::int64_t next_request_ns_ = 0;
};

} // namespace

ReplayedBus replay_interface(HostEstimator& estimator, std::span<const TrainedModel> models,
                             const BusDescription& description, const InterfaceOptions& options,
                             std::size_t horizon, const std::atomic<bool>& stop) {
    try {
        CanReplayer replayer(estimator, models, description, options.interface, horizon);
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
