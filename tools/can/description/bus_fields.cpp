// SPDX-License-Identifier: Apache-2.0
#include "tools/can/description/bus_fields.hpp"

#include "tools/can/families/family_catalogue.hpp"
#include "tools/can/families/family_fields.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace dfdyn::tools {

namespace {

using Names = std::vector<std::string_view>;

/// Allows the fields of `joints` or `output` that all families have, and those of this family.
void allow_only(const JsonReader& reader, Names names, const std::vector<FamilyField>& own) {
    std::ranges::copy(names_of(own), std::back_inserter(names));
    reader.allow_only(names);
}

const Names joint_fields{"family",   "boards",    "rate_hz",        "max_age_s",          "latency_s",
                         "jitter_s", "limit_rad", "velocity_limit", "acceleration_limit", "robot",
                         "encoder"};
const Names sensor_fields{"family",   "rate_hz", "max_age_s",     "latency_s",
                          "jitter_s", "limit",   "pair_window_s", "frozen_after"};

} // namespace

std::int64_t nanoseconds_or(const JsonReader& reader, const std::string& name, double absent_s) {
    return std::llround(1e9 * reader.number_or(name, absent_s, 0, 60));
}

std::uint32_t identifier_or(const JsonReader& reader, const std::string& name, std::uint32_t absent) {
    if (!reader.has(name)) {
        return absent;
    }
    const std::string text = reader.text(name);
    std::uint32_t id = 0;
    const char* const begin = text.data() + (text.starts_with("0x") ? 2 : 0);
    const char* const end = text.data() + text.size();
    const auto [rest, fault] = std::from_chars(begin, end, id, 16);
    if (fault != std::errc() || rest != end || !text.starts_with("0x") || id > 0x7FF) {
        throw reader.error(name, R"(an identifier from "0x0" to "0x7FF")", in_quotes(text));
    }
    return id;
}

std::string identifier_text(std::uint32_t id) {
    std::array<char, 8> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), id, 16).ptr;
    return "0x" + std::string(digits.data(), end);
}

void read_boards(const JsonReader& joints, const std::filesystem::path& folder, BusDescription& description) {
    const JointFamily& family = joint_family(joints);
    allow_only(joints, joint_fields, family.fields);
    description.joint_family = &family;
    family.read(joints, folder, description);
}

bool measures_efforts(const std::vector<BusBoard>& boards) {
    return std::ranges::all_of(boards, [](const BusBoard& board) { return board.board->measures_effort(); });
}

DescribedWrenchSensor read_wrench_sensor(const JsonReader& output, const std::filesystem::path& folder) {
    const SensorFamily& family = sensor_family(output);
    allow_only(output, sensor_fields, family.fields);
    return family.read(output, folder);
}

} // namespace dfdyn::tools
