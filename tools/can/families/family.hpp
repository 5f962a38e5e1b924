// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/json_reader.hpp"
#include "tools/can/description/bus_description.hpp"

#include <array>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// A field of bus.json. `meaning` follows the name in docs/reference/can.md: range, unit, what it is without
/// the field.
struct FamilyField {
    std::string_view name;
    std::string_view meaning;
};

/// A family of boards with joints: the only place that the program has it, beside its codec in the HAL.
struct JointFamily {
    std::string_view name;                 ///< `joints.family`
    std::vector<FamilyField> board_fields; ///< of each entry of `boards`
    std::vector<FamilyField> fields;       ///< of `joints`, besides those of every family
    std::string_view dbc = "";             ///< in hal/dbc, for other programs; "": none
    /// `joints` of an arm with two of them, for the tests; "": none, because it needs another file.
    std::string_view example = "";

    /// Adds the boards of `joints` to `description`, which has its trigger and rates. Files that `joints`
    /// names are in `folder`. Errors as of JsonReader; that there are no other fields has been checked.
    void (*read)(const JsonReader& joints, const std::filesystem::path& folder, BusDescription& description);

    /// The frame at which its devices measure, where they can be synchronous; null: they cannot.
    hal::Frame (*sync)() = nullptr;
    /// The frames of all boards of an arm, `values` of each, where boards share frames; null: they do not.
    std::vector<hal::Frame> (*encode_together)(
        std::span<const BusBoard> boards, std::span<const std::array<hal::JointValue, 2>> values) = nullptr;
};

struct DescribedWrenchSensor {
    AnySensor device;
    std::array<double, 6> limit; ///< what it can measure, ±
};

/// A family of force/torque sensors, likewise.
struct SensorFamily {
    std::string_view name; ///< `output.family`
    std::vector<FamilyField> fields;
    std::string_view dbc = "";
    std::string_view example = ""; ///< `output`

    DescribedWrenchSensor (*read)(const JsonReader& output, const std::filesystem::path& folder);
};

} // namespace dfdyn::tools
