// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/joint_count.hpp"
#include "dfdyn/hal/gate/pairing.hpp"
#include "dfdyn/hal/gate/range.hpp"
#include "dfdyn/hal/motion/motion.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/can/description/any_device.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Largest number of joints in a bus description.
inline constexpr int largest_bus_joint_count = hal::largest_joint_count;

/// Time at which a sample is assembled; see hal::SampleAssembly.
enum class BusTrigger {
    sync,  ///< at each SYNC, for the preceding SYNC
    timer, ///< at the sample rate, for the time `delay` ago
    set    ///< when every joint and the output have new values
};

/// Send rate of a source, and how long its values are valid.
struct BusSource {
    double rate_hz = 0;
    std::int64_t max_age_ns = 0;
    std::int64_t latency_ns = 0; ///< from the measurement to the end of its frame
    std::int64_t jitter_ns = 0;  ///< largest difference between the delays of two frames
};

struct JointFamily; // families/family.hpp

/// A board and its joints of the arm (from 0; hal::unused_joint for a joint that the arm does not have).
struct BusBoard {
    AnyBoard board;
    std::array<int, 2> joint{hal::unused_joint, hal::unused_joint};
};

/// An arm on a CAN bus: its devices, identifiers and rates (`dfdyn.bus/1`, docs/reference/can.md).
struct BusDescription {
    std::string source; ///< the file name as given by the user
    int joint_count = 0;
    OutputKind outputs = OutputKind::wrench;
    double bit_rate = 0;      ///< bit/s
    double data_bit_rate = 0; ///< bit/s, of the data of CAN FD frames that switch it
    double sample_rate_hz = 0;
    BusTrigger trigger = BusTrigger::timer;
    std::int64_t delay_ns = 0; ///< delay of a timer's samples: from the sample time to the assembly

    const JointFamily* joint_family = nullptr; ///< family of all boards
    std::vector<BusBoard> boards;              ///< each joint of the arm is on exactly one board
    bool synchronous = false; ///< the boards measure at a SYNC, which is sent at the joints' rate
    BusSource joints;
    double position_limit_rad = 0;               ///< positions beyond ± this limit are rejected
    std::vector<hal::MotionLimits> joint_limits; ///< per joint

    std::optional<AnySensor> sensor; ///< none: the outputs are the efforts of the joints
    BusSource output;
    std::vector<hal::Range> output_range; ///< one per output
    hal::PairGate::Config pairing{};      ///< pairing of the two frames of a wrench
    int frozen_after = 0;                 ///< number of identical wrenches, see hal::FrozenWrenchGate

    [[nodiscard]] double data_rate_ratio() const { return data_bit_rate / bit_rate; }
    [[nodiscard]] std::int64_t sample_period_ns() const { return std::llround(1e9 / sample_rate_hz); }
};

/// Reads a bus description. Throws InputError `FILE: path.to.field: expected …, found …` if the file is
/// malformed, if a device is impossible, if a joint is missing or duplicated, or if two devices share an
/// identifier.
BusDescription read_bus_description(const std::filesystem::path& path);

/// The same for a description that is not in a file. `source` is its name in errors.
BusDescription parse_bus_description(const nlohmann::json& json, const std::string& source);

} // namespace dfdyn::tools
