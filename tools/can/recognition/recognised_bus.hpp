// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bus.hpp"
#include "tools/can/check/bus_check.hpp"
#include "tools/can/description/bus_finding.hpp"
#include "tools/can/families/family.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Sums the time between frames, without pauses of the bus and steps of its clock. Frames that come late are
/// not a step.
class TrafficTime {
  public:
    void take(std::int64_t stamp_ns) noexcept;
    double seconds() const noexcept { return seconds_of(sum_ns_); }

  private:
    std::optional<std::int64_t> latest_ns_;
    std::int64_t sum_ns_ = 0;
};

/// Stores the first frames of a bus without a description: `longest_s` of traffic, without its pauses.
class TrafficRecorder {
  public:
    static constexpr double longest_s = 5;
    static constexpr std::size_t most_frames = 200'000;

    TrafficRecorder() { frames_.reserve(most_frames); }
    void take(const hal::Frame& frame) noexcept;
    std::span<const hal::Frame> frames() const noexcept { return frames_; }

  private:
    std::vector<hal::Frame> frames_;
    TrafficTime time_;
};

/// A bus whose frames are also recorded, and that sends nothing.
template <class B>
class RecordedBus {
  public:
    RecordedBus(B& bus, TrafficRecorder& recorder) : bus_(bus), recorder_(recorder) {}

    std::span<const hal::Frame> drain(std::span<hal::Frame> into) noexcept {
        const std::span<const hal::Frame> frames = bus_.drain(into);
        for (const hal::Frame& frame : frames) {
            recorder_.take(frame);
        }
        return frames;
    }
    hal::SendResult send(const hal::Frame& /*frame*/) noexcept { return hal::SendResult::refused; }
    hal::BusState state() const noexcept { return bus_.state(); }
    const hal::BusCounters& counters() const noexcept { return bus_.counters(); }
    std::int64_t now_ns() const noexcept { return bus_.now_ns(); }

  private:
    B& bus_;
    TrafficRecorder& recorder_;
};

/// A recognised family.
struct RecognisedFamily {
    const JointFamily* family = nullptr; ///< its entry in the catalogue
    Recognition recognition;
};

/// Result of the recognition of a bus without a description.
struct RecognisedBus {
    double duration_s = 0; ///< duration of the evaluated frames, without pauses
    std::vector<RecognisedFamily>
        families;                        ///< families with joints; the first one with efforts is in the draft
    std::optional<nlohmann::json> draft; ///< a valid description; none without joints and efforts
    std::string draft_error;             ///< reason for a missing draft
    std::vector<BusFinding> findings;    ///< of the draft's devices, in these frames
    std::vector<std::string> commands;   ///< commands of other programs
};

/// Recognises the devices that sent these frames, which must be in the order of their arrival.
RecognisedBus recognise_bus(std::span<const hal::Frame> frames);

/// Adds the findings of `bus` that are not yet among `findings`, which are those of `check`, of all frames.
/// Removes those about an identifier whose sender changed its state and sends under another one.
void add_findings(const RecognisedBus& bus, const BusCheck& check, std::vector<BusFinding>& findings);

/// Returns the figures of print_recognised_bus: `families` (names), `recognised` (boards with their rates,
/// uncertain properties), `commands`, and `draft_error`, which is null if there is a draft.
nlohmann::ordered_json recognised_json(const RecognisedBus& bus);

/// Prints the families with their boards, rates and uncertain properties.
void print_recognised_bus(std::ostream& out, const RecognisedBus& bus);

} // namespace dfdyn::tools
