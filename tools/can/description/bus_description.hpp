// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/gate/motion.hpp"
#include "dfdyn/hal/gate/pairing.hpp"
#include "dfdyn/hal/gate/range.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/can/description/any_device.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The largest arm that a bus description may have.
inline constexpr int largest_bus_joint_count = 12;

/// When a sample is assembled; see hal::SampleAssembly.
enum class BusTrigger {
    sync,  ///< at each SYNC, of the SYNC before
    timer, ///< at the sample rate, of `delay` ago
    set    ///< once every joint and the output are new
};

/// How often a source sends, and for how long what it sent is good.
struct BusSource {
    double rate_hz = 0;
    std::int64_t max_age_ns = 0;
    std::int64_t latency_ns = 0; ///< from the measurement to the end of its frame
    std::int64_t jitter_ns = 0;  ///< by how much a frame is later than another, at most
};

struct JointFamily; // families/family.hpp

/// A board, and which joints of the arm its own ones are (from 0; hal::unused_joint for none).
struct BusBoard {
    AnyBoard board;
    std::array<int, 2> joint{hal::unused_joint, hal::unused_joint};
};

/// An arm on a CAN bus: which devices, where, how often (`dfdyn.bus/1`, docs/reference/can.md).
struct BusDescription {
    std::string source; ///< the file, as the user named it
    int joint_count = 0;
    OutputKind outputs = OutputKind::wrench;
    double bit_rate = 0; ///< bit/s
    double sample_rate_hz = 0;
    BusTrigger trigger = BusTrigger::timer;
    std::int64_t delay_ns = 0; ///< of a timer's samples behind the time at which they are assembled

    const JointFamily* joint_family = nullptr; ///< of all boards
    std::vector<BusBoard> boards;              ///< each joint of the arm is on exactly one
    bool synchronous = false;                  ///< they measure at a SYNC, which is sent at the joints' rate
    BusSource joints;
    double position_limit_rad = 0;               ///< positions beyond ± this are not believed
    std::vector<hal::MotionLimits> joint_limits; ///< per joint

    std::optional<AnySensor> sensor; ///< none: the outputs are the joints' own efforts
    BusSource output;
    std::vector<hal::Range> output_range; ///< one per output
    hal::PairGate::Config pairing{};      ///< of a wrench's two frames
    int frozen_after = 0;                 ///< identical wrenches, see hal::FrozenGate

    [[nodiscard]] std::int64_t sample_period_ns() const { return std::llround(1e9 / sample_rate_hz); }
};

/// Reads a bus description. Throws InputError `FILE: path.to.field: expected …, found …` for a file that is
/// malformed, devices that cannot be, a joint that is missing or twice, identifiers that two devices share.
BusDescription read_bus_description(const std::filesystem::path& path);

} // namespace dfdyn::tools
