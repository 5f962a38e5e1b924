// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/replay_bus.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tools/can/check/bus_check.hpp"

#include <functional>
#include <set>

/// Logs of arms without faults, functions that add faults, and the rules of buscheck that then report a
/// finding.
namespace dfdyn::tests {

using hal::Frame;
using tools::BusCheck;
using tools::BusDescription;
using Frames = std::vector<Frame>;
using Names = std::set<std::string>;

/// Frames as a recording whose recorder lost some of them.
class Tape {
  public:
    explicit Tape(Frames frames, std::uint64_t dropped = 0) : frames_(std::move(frames)), dropped_(dropped) {}

    bool next(hal::ReplayEntry& entry) noexcept {
        entry = {};
        if (next_ == frames_.size()) {
            return false;
        }
        entry.frame = frames_[next_++];
        entry.dropped_before = next_ == frames_.size() / 2 ? dropped_ : 0;
        return true;
    }

  private:
    Frames frames_;
    std::uint64_t dropped_;
    std::size_t next_ = 0;
};

using TapeBus = hal::ReplayBus<Tape>;

template <class Watched>
void watch(BusCheck& check, TapeBus& bus, Watched& watched) {
    std::array<Frame, 1> room{};
    while (!bus.ended()) {
        bus.advance_to(bus.next_stamp_ns());
        check.take(watched, room);
    }
    check.finish();
}

inline BusCheck checked(const std::optional<BusDescription>& description, const Frames& frames,
                        std::uint64_t dropped = 0) {
    BusCheck check(description);
    Tape tape(frames, dropped);
    TapeBus bus(tape);
    watch(check, bus, bus);
    return check;
}

inline Names rules_of(const BusCheck& check) {
    Names names;
    for (const tools::BusFinding& finding : tools::bus_findings(check)) {
        for (const std::string& text : {finding.what, finding.evidence, finding.confirm, finding.fix}) {
            CHECK_FALSE(text.empty());
        }
        names.insert(finding.rule);
    }
    return names;
}

inline Names rules(const std::optional<BusDescription>& description, const Frames& frames,
                   std::uint64_t dropped = 0) {
    return rules_of(checked(description, frames, dropped));
}

inline BusDescription described(const std::string& text) {
    const TemporaryDirectory directory;
    return tools::read_bus_description(directory.write("bus.json", text));
}

/// Returns an output of the arm without noise, within the range of the efforts of every description.
inline double sound_output(const BusDescription& description, double time_s) {
    return (description.sensor ? 2 : 1) + 0.5 * std::sin(2 * time_s);
}

/// Returns the frames of the devices of an arm in motion. `shift_rad` is added to all positions.
inline Frames sound(const BusDescription& description, double duration_s = 4, double jitter_us = 20,
                    double shift_rad = 0) {
    Frames frames;
    tools::BusTraffic traffic(description, {jitter_us, 1},
                              [&](const Frame& frame) { frames.push_back(frame); });
    std::mt19937_64 engine(seed());
    std::normal_distribution<double> noise;
    const double rate_hz = std::max(description.joints.rate_hz, description.output.rate_hz);
    const auto joints = static_cast<std::size_t>(description.joint_count);
    for (std::int64_t row = 0; static_cast<double>(row) < duration_s * rate_hz; ++row) {
        const double t = static_cast<double>(row) / rate_hz;
        std::vector<double> position(joints);
        std::vector<double> output(description.sensor ? 6 : joints);
        for (std::size_t i = 0; i < joints; ++i) {
            position[i] = 0.4 + shift_rad + 0.2 * std::sin(t + static_cast<double>(i));
        }
        for (std::size_t k = 0; k < output.size(); ++k) {
            output[k] = sound_output(description, t) + 0.1 * noise(engine);
        }
        traffic.add(std::llround(1e9 * t), position, output);
    }
    traffic.finish();
    return frames;
}

inline BusDescription drives() { return tools::read_bus_description(bus_folder + "ur5_cia402.json"); }

inline BusDescription icub() { return tools::read_bus_description(bus_folder + "icub_arm_strain.json"); }

inline const std::string odrive_and_ati = R"({
  "schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 100, "trigger": {"on": "timer"},
  "joints": {"family": "odrive", "boards": [{"node": 1, "joint": 1, "motor_per_joint": 9},
                                            {"node": 2, "joint": 2, "motor_per_joint": -9}]},
  "output": {"family": "ati_netcan", "base": 32, "counts_per_newton": 100, "counts_per_newton_metre": 5000,
             "limit": [200, 200, 200, 6, 6, 6], "rate_hz": 200,
             "matrix": [1,0,0,0,0,0, 0,1,0,0,0,0, 0,0,1,0,0,0, 0,0,0,1,0,0, 0,0,0,0,1,0, 0,0,0,0,0,1]}
})";
inline const std::string foc_and_robotous = R"({
  "schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 500, "trigger": {"on": "set"},
  "joints": {"family": "icub_2foc", "boards": [{"address": 1, "joint": 1}, {"address": 2, "joint": 2}]},
  "output": {"family": "robotous_rft"}
})";

inline Frames without(Frames frames, const std::function<bool(const Frame&)>& gone) {
    std::erase_if(frames, gone);
    return frames;
}

inline Frames changed(Frames frames, const std::function<void(Frame&)>& change) {
    std::ranges::for_each(frames, change);
    std::ranges::stable_sort(frames, {}, &Frame::stamp_ns);
    return frames;
}

/// Inserts a frame in the middle.
inline Frames with(Frames frames, Frame frame) {
    const std::size_t at = frames.size() / 2;
    frame.stamp_ns = frames[at].stamp_ns;
    frames.insert(frames.begin() + static_cast<std::ptrdiff_t>(at), frame);
    return frames;
}

inline Frame error_frame(std::uint32_t classes, std::uint8_t detail = 0) {
    Frame frame;
    frame.error = true;
    frame.id = classes;
    frame.length = 8;
    frame.data[1] = detail;
    return frame;
}

} // namespace dfdyn::tests
