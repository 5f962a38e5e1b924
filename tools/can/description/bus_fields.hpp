// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/json_reader.hpp"
#include "tools/base/text/text.hpp"
#include "tools/can/description/bus_description.hpp"
#include "tools/can/families/family.hpp"

#include <string>

namespace dfdyn::tools {

/// A field of a bus description that a file may leave out. Errors as of JsonReader. Seconds in the file, from
/// 0 to 60.
std::int64_t nanoseconds_or(const JsonReader& reader, const std::string& name, double absent_s);

/// `"0x280"`: an identifier of 11 bits.
std::uint32_t identifier_or(const JsonReader& reader, const std::string& name, std::uint32_t absent);
std::string identifier_text(std::uint32_t id);

/// `family`, `boards` and what belongs to the family. `description` has its rates and trigger; the files that
/// `joints` names are in `folder`.
void read_boards(const JsonReader& joints, const std::filesystem::path& folder, BusDescription& description);

/// Whether the boards' frames carry efforts.
bool measures_efforts(const std::vector<BusBoard>& boards);

/// `family` and what belongs to it; files likewise.
DescribedWrenchSensor read_wrench_sensor(const JsonReader& output, const std::filesystem::path& folder);

} // namespace dfdyn::tools
