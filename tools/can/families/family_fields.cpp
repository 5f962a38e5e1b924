// SPDX-License-Identifier: Apache-2.0
#include "tools/can/families/family_fields.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

std::vector<std::string_view> names_of(const std::vector<FamilyField>& fields) {
    std::vector<std::string_view> names;
    std::ranges::transform(fields, std::back_inserter(names), &FamilyField::name);
    return names;
}

int read_joint(const JsonReader& board) {
    return board.whole_number("joint", 1, largest_bus_joint_count) - 1;
}

double read_ratio(double value, const JsonReader& reader, const std::string& name) {
    if (!(std::abs(value) > 1e-9)) {
        throw reader.error(name, "a number that is not 0", std::to_string(value));
    }
    return value;
}

double read_ratio(const JsonReader& reader, const std::string& name) {
    return read_ratio(reader.number(name), reader, name);
}

double ratio_or(const JsonReader& reader, const std::string& name, double absent) {
    return reader.has(name) ? read_ratio(reader, name) : absent;
}

double read_zero_rad(const JsonReader& board) { return board.number_or("zero_rad", 0, -1000, 1000); }

void take_own_id(const JsonReader& board, const std::string& name, int id, std::vector<int>& taken) {
    if (std::ranges::find(taken, id) != taken.end()) {
        throw board.error(name, "a number of its own", std::to_string(id) + " again");
    }
    taken.push_back(id);
}

void reject_fields(const JsonReader& reader, std::initializer_list<const char*> names,
                   const std::string& chosen) {
    for (const char* const name : names) {
        if (reader.has(name)) {
            throw reader.error(name, "no such field with " + chosen, "one");
        }
    }
}

std::array<double, 6> read_limit(const JsonReader& output) {
    std::array<double, 6> limit{};
    std::ranges::copy(output.positive_numbers("limit", 6), limit.begin());
    return limit;
}

std::array<double, 6> limit_or(const JsonReader& output, double force, double torque) {
    return output.has("limit") ? read_limit(output)
                               : std::array<double, 6>{force, force, force, torque, torque, torque};
}

} // namespace dfdyn::tools
