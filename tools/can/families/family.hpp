// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/json_reader.hpp"
#include "tools/can/description/bus_description.hpp"
#include "tools/can/families/motor_type.hpp"
#include "tools/can/families/recognition.hpp"

#include <array>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// JointFamily::no_draft of a family without efforts.
inline constexpr std::string_view no_efforts = "its frames contain no efforts";

/// A field of bus.json. `meaning` follows the name in docs/reference/can.md: range, unit, default.
struct FamilyField {
    std::string_view name;
    std::string_view meaning;
};

/// Steps of a finding: a check that would confirm it, and the remedy. See BusFinding.
struct Remedy {
    std::string_view confirm;
    std::string_view fix;
};

/// A family of boards with joints: all its properties except its codec in the HAL.
struct JointFamily {
    std::string_view name;                 ///< value of `joints.family`
    std::vector<FamilyField> board_fields; ///< fields of each entry of `boards`
    std::vector<FamilyField> fields;       ///< fields of `joints`, besides those of every family
    std::string_view dbc = {};             ///< file in hal/dbc for other programs; "": none
    /// `joints` of an arm with two joints, for the tests; "": none, because it needs another file.
    std::string_view example = {};

    /// Adds the boards of `joints` to `description`, which has its trigger and rates. Files named in `joints`
    /// are relative to `folder`. Errors like those of JsonReader; the names of the fields are already
    /// checked.
    void (*read)(const JsonReader& joints, const std::filesystem::path& folder, BusDescription& description);

    std::string_view devices = {};              ///< description of its devices, for docs/reference/devices.md
    std::vector<std::string_view> sources = {}; ///< sources of its frame layouts and numbers
    std::vector<std::string_view> pitfalls = {}; ///< frequent decoding errors, one sentence each
    std::vector<MotorType> types = {};           ///< motor types that bus.json can name

    /// Recognises its devices in the frames of a bus without a description; null: not supported. Sends
    /// nothing.
    Recognition (*recognise)(FrameSpan frames) = nullptr;
    std::string_view no_draft = {}; ///< reason why its recognition has no `quantity`; "": it has one
    /// Returns the identifier of a frame without the state of its sender, as in the frames of the codec's
    /// `encode`; null: identifiers contain none.
    std::uint32_t (*stream_id)(const hal::Frame& frame) = nullptr;

    /// Returns the frame at which synchronous devices measure; null: they cannot be synchronous.
    hal::Frame (*sync)() = nullptr;
    /// Encodes the frames of all boards of an arm, with the `values` of each, if boards share frames;
    /// otherwise null.
    std::vector<hal::Frame> (*encode_together)(
        std::span<const BusBoard> boards, std::span<const std::array<hal::JointValue, 2>> values) = nullptr;
    /// If a device is not in its operational state; by default that of CANopen.
    Remedy not_operational = {"read its heartbeat: candump IFACE,700:780", "Start the node (NMT start)."};
};

struct DescribedWrenchSensor {
    AnySensor device;
    std::array<double, 6> limit; ///< measuring range per axis, ±
};

/// A family of force/torque sensors: members of JointFamily with the same meaning. `buscheck` does not
/// recognise sensors without a description.
struct SensorFamily {
    std::string_view name; ///< value of `output.family`
    std::vector<FamilyField> fields;
    std::string_view dbc = {};
    std::string_view example = {}; ///< `output` of an arm, for the tests
    std::string_view devices = {};

    DescribedWrenchSensor (*read)(const JsonReader& output, const std::filesystem::path& folder);
};

} // namespace dfdyn::tools
