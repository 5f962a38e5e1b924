// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/json_reader.hpp"
#include "tools/base/text/text.hpp"
#include "tools/can/description/bus_description.hpp"
#include "tools/can/families/family.hpp"

#include <string>

namespace dfdyn::tools {

/// Reads an optional duration in seconds, from 0 to 60, and returns nanoseconds. Errors like those of
/// JsonReader.
std::int64_t nanoseconds_or(const JsonReader& reader, const std::string& name, double absent_s);

/// Reads an optional 11-bit identifier such as `"0x280"`.
std::uint32_t identifier_or(const JsonReader& reader, const std::string& name, std::uint32_t absent);
std::string identifier_text(std::uint32_t id);

/// Reads `family`, `boards` and the fields of the family. `description` already has its rates and trigger.
/// Files named in `joints` are relative to `folder`.
void read_boards(const JsonReader& joints, const std::filesystem::path& folder, BusDescription& description);

/// Returns true if the boards' frames carry efforts.
bool measures_efforts(const std::vector<BusBoard>& boards);

/// Reads `family` and its fields for a sensor. Files named there are relative to `folder`.
DescribedWrenchSensor read_wrench_sensor(const JsonReader& output, const std::filesystem::path& folder);

} // namespace dfdyn::tools
