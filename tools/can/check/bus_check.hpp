// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/arm/bus_arm.hpp"
#include "tools/can/check/bus_load.hpp"
#include "tools/can/check/bus_stream.hpp"
#include "tools/can/check/sample_counts.hpp"
#include "tools/can/check/sequence_watch.hpp"
#include "tools/can/check/stream_clock.hpp"
#include "tools/can/check/value_watch.hpp"
#include "tools/can/description/bus_finding.hpp"

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A joint of the description, as its device reports it.
struct CheckedJoint {
    ValueWatch values;
    std::uint64_t restarts = 0; ///< times that its device reported a restart between its values
    BusStreamKey position_key;  ///< identifier of its positions
    std::size_t board = 0;      ///< its board
    std::uint64_t frames = 0;   ///< frames with its values
    std::int64_t first_ns = 0;  ///< stamp of the first one
    std::int64_t last_ns = 0;   ///< stamp of the last one
};

/// Observes a bus and checks the rate of each sender, and whether the frames agree with the description.
/// Without a description it checks how regularly each identifier is sent. It sends nothing. Jumps of the
/// clock are removed from the time stamps (StreamClock). Memory: at most `most_streams` identifiers.
class BusCheck {
  public:
    static constexpr std::size_t most_streams = 4096;

    explicit BusCheck(std::optional<BusDescription> description);

    /// Reads the waiting frames, up to the size of its buffer. Returns true if there were any.
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

    /// Declares the end of the frames. Call once, at the end.
    void finish();

    /// The description; null if there is none.
    const BusDescription* description() const noexcept { return description_ ? &*description_ : nullptr; }
    const BusStreams& streams() const noexcept { return streams_; }
    const hal::BusCounters& counters() const noexcept { return counters_; }
    hal::BusState state() const noexcept { return state_; }
    hal::BusState worst_state() const noexcept { return worst_; }
    const StreamClock& clock() const noexcept { return clock_; }
    /// Number of times that a device reported lost messages.
    std::uint64_t device_losses() const noexcept;
    /// frames sent by programs of this computer
    std::uint64_t from_host() const noexcept { return from_host_; }
    double duration_s() const;                   ///< duration of the observation
    double age_s(const BusStream& stream) const; ///< age of the last frame at the end of the observation
    /// Returns true if frames dropped by this computer explain all missing frames.
    bool dropped_all_missing() const;
    const BusLoad& load() const noexcept { return load_; }
    const ReadingOrder& order() const noexcept { return order_; }
    /// The samples of the described arm, assembled at the sample rate.
    const SampleCounts& samples() const noexcept { return samples_; }

    /// The joints of the description.
    const std::vector<CheckedJoint>& joints() const noexcept { return joints_; }
    /// The stream with the joint's positions; null if there is none.
    const BusStreams::value_type* position_stream(std::size_t joint) const;
    /// Returns true if a joint that shares an identifier sent no values in its last ten periods.
    bool lacks_values(std::size_t joint) const;
    /// Returns true if this holds for a joint with this identifier, whose rate is then not the described one.
    bool lacks_a_sender(const BusStreamKey& key) const;
    /// The boards after all frames; empty without a description.
    const std::vector<BusBoard>& boards() const noexcept { return boards_; }
    /// The sensor after all frames; null without one.
    const AnySensor* sensor() const noexcept { return arm_ ? arm_->sensor() : nullptr; }

  private:
    void update(hal::BusState state, const hal::BusCounters& counters);
    void take(const hal::Frame& frame);
    void take(const StreamClock::Timed& timed);
    void pass(std::int64_t time_ns);
    void describe();
    void describe_joints();
    void expect(std::span<const hal::Frame> frames, double rate_hz);
    void name_sender(std::span<const hal::Frame> frames, const std::string& name);
    bool claimed(const hal::Frame& frame) const;
    bool carries_no_values(const hal::Frame& frame) const;
    void watch_joints(const hal::Frame& frame);
    BusStreamKey key_of(const hal::Frame& frame) const;
    BusStream* stream_of(const hal::Frame& frame);
    void watch_answers(BusStream& stream, const hal::Frame& frame);
    void assemble(std::int64_t now_ns);

    std::optional<BusDescription> description_;
    std::optional<BusArm> arm_; ///< none without a description
    std::vector<BusBoard> boards_;
    std::vector<CheckedJoint> joints_;
    StreamClock clock_;
    BusStreams streams_;
    hal::BusCounters counters_;
    hal::BusState state_ = hal::BusState::active, worst_ = hal::BusState::active;
    std::int64_t first_ns_ = 0, last_ns_ = 0;
    std::int64_t next_sample_ns_ = std::numeric_limits<std::int64_t>::min();
    BusLoad load_;
    ReadingOrder order_;
    SampleCounts samples_;
    std::int64_t heartbeat_timeout_ns_ = 0; ///< the longest of all boards
    std::optional<BusStreamKey> sync_key_;
    std::int64_t sync_ns_ = 0; ///< stamp of the last SYNC; 0: none
    std::uint64_t from_host_ = 0;
    bool started_ = false;
};

/// Findings about the bus, then about each source, then about what the devices report.
std::vector<BusFinding> bus_findings(const BusCheck& check);

/// Findings about single sources.
std::vector<BusFinding> source_findings(const BusCheck& check);

/// Returns true if a finding reports that a source sends more frames than its sequence has.
bool sends_more(const BusCheck& check, const BusStreams::value_type& source);

/// Returns true if a finding reports lost or late frames of a source.
bool is_late_or_lost(const BusCheck& check, const BusStreams::value_type& source);

/// Findings about the joints' values and about the condition reported by the sensor.
std::vector<BusFinding> value_findings(const BusCheck& check);

/// Returns the figures of print_bus_check: schema `dfdyn.buscheck/1`. The bit rate and the loads are null if
/// they are unknown.
nlohmann::ordered_json bus_check_json(const BusCheck& check, std::span<const BusFinding> findings);

/// Prints the table of sources, the state of the bus and the findings.
void print_bus_check(std::ostream& out, const BusCheck& check, std::span<const BusFinding> findings);

} // namespace dfdyn::tools
