// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/arm/bus_arm.hpp"
#include "tools/can/check/bus_stream.hpp"
#include "tools/can/check/stream_clock.hpp"
#include "tools/can/check/value_watch.hpp"
#include "tools/can/description/bus_finding.hpp"

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Watches a bus: who sends how often, and what the description makes of it; without a description who sends
/// how steadily. Sends nothing. Stamps count without the jumps of their clock (StreamClock). Memory: at most
/// `most_streams` identifiers.
class BusCheck {
  public:
    static constexpr std::size_t most_streams = 4096;

    explicit BusCheck(std::optional<BusDescription> description);

    /// Takes what a bus has, as much as there is room for; whether there was anything.
    template <hal::Bus B>
    bool take(B& bus, std::span<hal::Frame> room) {
        const std::span<const hal::Frame> frames = bus.drain(room);
        update(bus.state(), bus.counters());
        for (const hal::Frame& frame : frames) {
            take(frame);
        }
        if (frames.empty()) {
            pass(clock_.time_of(bus.now_ns()));
        }
        return !frames.empty();
    }

    /// Nothing comes any more; call once, last.
    void finish();

    /// Null where nobody described the bus.
    const BusDescription* description() const noexcept { return description_ ? &*description_ : nullptr; }
    double bit_rate() const noexcept { return description_ ? description_->bit_rate : 0; } ///< 0: not known
    const BusStreams& streams() const noexcept { return streams_; }
    const hal::BusCounters& counters() const noexcept { return counters_; }
    hal::BusState state() const noexcept { return state_; }
    hal::BusState worst_state() const noexcept { return worst_; }
    const StreamClock& clock() const noexcept { return clock_; }
    /// Times that a device said that it lost messages.
    std::uint64_t device_losses() const noexcept;
    std::uint64_t from_host() const noexcept { return from_host_; } ///< frames of programs of this computer
    double duration_s() const;                                      ///< of what was watched
    double age_s(const BusStream& stream) const;                    ///< of its last frame, at the end
    /// Whether this computer dropped as many frames as all sources together miss.
    bool dropped_all_missing() const;
    double load() const;          ///< share of the bit rate that the frames took, each at its worst
    double expected_load() const; ///< that the description's sources would take; both 0 without a bit rate

    /// Samples assembled, and how many of them had a reason, of the positions or the output.
    std::uint64_t samples() const noexcept { return samples_; }
    std::uint64_t refused(hal::Reason reason) const;
    /// Whether the last sample had it.
    bool still(hal::Reason reason) const;

    /// Of each joint of the description.
    const std::vector<ValueWatch>& joints() const noexcept { return joints_; }
    /// Times that the device of a joint said that it restarted between its values.
    std::uint64_t restarts(std::size_t joint) const { return restarts_.at(joint); }
    /// The stream that has a joint's positions; null where there is none.
    const BusStream* position_stream(std::size_t joint) const;
    /// The boards as they are after all frames; none without a description.
    const std::vector<BusBoard>& boards() const noexcept { return boards_; }
    /// The sensor, likewise; null without one.
    const AnySensor* sensor() const noexcept { return arm_ ? arm_->sensor() : nullptr; }

  private:
    void update(hal::BusState state, const hal::BusCounters& counters);
    void take(const hal::Frame& frame);
    void take(const StreamClock::Timed& timed);
    void pass(std::int64_t time_ns);
    void describe();
    void expect(std::span<const hal::Frame> frames, double rate_hz);
    void name_sender(std::span<const hal::Frame> frames, const std::string& name);
    bool claimed(const hal::Frame& frame) const;
    bool is_request(const hal::Frame& frame) const;
    void watch_joints(const hal::Frame& frame);
    BusStream* stream_of(const hal::Frame& frame);
    void assemble(std::int64_t now_ns);

    std::optional<BusDescription> description_;
    std::unique_ptr<BusArm> arm_; ///< null without a description
    std::vector<BusBoard> boards_;
    std::vector<ValueWatch> joints_;
    std::vector<std::uint64_t> restarts_;
    std::vector<BusStreamKey> position_keys_; ///< of each joint
    StreamClock clock_;
    BusStreams streams_;
    hal::BusCounters counters_;
    hal::BusState state_ = hal::BusState::active, worst_ = hal::BusState::active;
    std::int64_t first_ns_ = 0, last_ns_ = 0;
    std::int64_t next_sample_ns_ = std::numeric_limits<std::int64_t>::min();
    double bits_ = 0;
    std::uint64_t from_host_ = 0;
    bool started_ = false;
    std::uint64_t samples_ = 0;
    std::array<std::uint64_t, hal::reason_count> refused_{};
    hal::Reason last_position_ = hal::Reason::ok, last_output_ = hal::Reason::ok;
};

/// Those of the bus, of each source, of what the devices say, in this order.
std::vector<BusFinding> bus_findings(const BusCheck& check);

/// Of each source alone.
std::vector<BusFinding> source_findings(const BusCheck& check);

/// Of the joints' values, and of what the sensor says of itself.
std::vector<BusFinding> value_findings(const BusCheck& check);

/// The table of sources, the bus, and the findings.
void print_bus_check(std::ostream& out, const BusCheck& check, std::span<const BusFinding> findings);

} // namespace dfdyn::tools
