// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/bus_arm.hpp"

#include <array>
#include <limits>
#include <map>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

/// The frames of one identifier.
struct BusStream {
    std::uint64_t count = 0;
    std::int64_t first_ns = 0, last_ns = 0;
    std::int64_t longest_gap_ns = 0;
    double interval_square_sum_s2 = 0;
    std::uint64_t rejected = 0;       ///< by the device's decoder
    std::uint64_t not_increasing = 0; ///< frames with a stamp not after the one before
    double bits = 0;                  ///< of all, at worst
    int length = 0;                   ///< of the last frame, or of the one that is expected; bytes
    bool known = false;               ///< the description says who sends it
    std::string sender;               ///< such as `joint 2`; empty where that is not known
    double expected_hz = 0;           ///< 0: not sent steadily, or nobody knows
    double expected_bits = 0;         ///< per second
    bool several = false;             ///< more than one frame per period

    double rate_hz() const;  ///< 0 for fewer than two frames
    double jitter_s() const; ///< standard deviation of the intervals; 0 for fewer than three frames
};

/// By extended, identifier.
using BusStreamKey = std::pair<bool, std::uint32_t>;
using BusStreams = std::map<BusStreamKey, BusStream>;
std::string id_text(const BusStreamKey& key);

/// Watches a bus: who sends how often, and what the description makes of it. Sends nothing. Memory: at most
/// `most_streams` identifiers.
class BusCheck {
  public:
    static constexpr std::size_t most_streams = 4096;

    explicit BusCheck(BusDescription description);

    /// Takes what a bus has, as much as there is room for; whether there was anything.
    template <hal::Bus B>
    bool take(B& bus, std::span<hal::Frame> room) {
        const std::span<const hal::Frame> frames = bus.drain(room);
        update(bus.state(), bus.counters(), bus.now_ns());
        for (const hal::Frame& frame : frames) {
            take(frame, bus.now_ns());
        }
        return !frames.empty();
    }

    const BusDescription& description() const noexcept { return description_; }
    const BusStreams& streams() const noexcept { return streams_; }
    const hal::BusCounters& counters() const noexcept { return counters_; }
    hal::BusState state() const noexcept { return state_; }
    hal::BusState worst_state() const noexcept { return worst_; }
    const hal::BusWatch& watch() const noexcept { return arm_->bus(); }
    double duration_s() const;                   ///< of what was watched
    double age_s(const BusStream& stream) const; ///< of its last frame, at the end
    double load() const;          ///< share of the bit rate that the frames took, each at its worst
    double expected_load() const; ///< that the description's sources would take

    /// Samples assembled, and how many of them had a reason, of the positions or the output.
    std::uint64_t samples() const noexcept { return samples_; }
    std::uint64_t refused(hal::Reason reason) const;
    /// Whether the last sample had it.
    bool still(hal::Reason reason) const;

  private:
    void update(hal::BusState state, const hal::BusCounters& counters, std::int64_t now_ns);
    void take(const hal::Frame& frame, std::int64_t now_ns);
    void expect(std::span<const hal::Frame> frames, double rate_hz);
    void name_sender(std::span<const hal::Frame> frames, const std::string& name);
    bool claimed(const hal::Frame& frame) const;
    bool is_request(const hal::Frame& frame) const;
    void count(const hal::Frame& frame, bool rejected);
    void assemble(std::int64_t now_ns);

    BusDescription description_;
    std::unique_ptr<BusArm> arm_;
    BusStreams streams_;
    hal::BusCounters counters_;
    hal::BusState state_ = hal::BusState::active, worst_ = hal::BusState::active;
    std::int64_t first_ns_ = 0, last_ns_ = 0;
    std::int64_t next_sample_ns_ = std::numeric_limits<std::int64_t>::min();
    double bits_ = 0;
    bool started_ = false;
    std::uint64_t samples_ = 0;
    std::array<std::uint64_t, hal::reason_count> refused_{};
    hal::Reason last_position_ = hal::Reason::ok, last_output_ = hal::Reason::ok;
};

/// What is wrong, in words for whoever stands in front of the robot.
struct BusFinding {
    std::string rule; ///< its name, stable
    std::string what;
    std::string evidence; ///< what it was inferred from
    std::string confirm;  ///< the check that would confirm it
    std::string fix;
};

/// Those of the bus, of each source, of what the devices say, in this order.
std::vector<BusFinding> bus_findings(const BusCheck& check);

/// Of each source alone.
std::vector<BusFinding> source_findings(const BusCheck& check);

/// The table of sources, the bus, and the findings.
void print_bus_check(std::ostream& out, const BusCheck& check, std::span<const BusFinding> findings);

} // namespace dfdyn::tools
