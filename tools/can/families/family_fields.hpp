// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/description/bus_fields.hpp"
#include "tools/can/families/family.hpp"

#include <array>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Readers of fields that several families have. Errors like those of JsonReader.

/// Names of a family's fields, for JsonReader::allow_only.
std::vector<std::string_view> names_of(const std::vector<FamilyField>& fields);

/// Reads `joint` of a board with one joint; it counts from 1 in the file and from 0 here.
int read_joint(const JsonReader& board);

/// Reads a ratio of counts, ticks or turns: negative for the opposite direction, never 0.
double read_ratio(const JsonReader& reader, const std::string& name);
double read_ratio(double value, const JsonReader& reader, const std::string& name);
double ratio_or(const JsonReader& reader, const std::string& name, double absent);

/// Reads `zero_rad` (default 0): the joint's position where the encoder shows 0.
double read_zero_rad(const JsonReader& board);

/// Notes the number `id` of a board, read from its field `name`. Throws InputError if it is in `taken`.
void take_own_id(const JsonReader& board, const std::string& name, int id, std::vector<int>& taken);

/// Throws InputError for a field of `names`, which have no meaning with the `chosen` option.
void reject_fields(const JsonReader& reader, std::initializer_list<const char*> names,
                   const std::string& chosen);

/// Reads `limit`: the measuring range ± per axis.
std::array<double, 6> read_limit(const JsonReader& output);
/// Reads `limit`. Without the field, returns `force` and `torque` for their axes.
std::array<double, 6> limit_or(const JsonReader& output, double force, double torque);

/// Adds the BusBoard `read(board)` for each entry of `boards`.
template <class Read>
void read_each_board(const JsonReader& joints, Read read, BusDescription& description) {
    for (const JsonReader& board : joints.objects("boards", 1, largest_bus_joint_count)) {
        description.boards.push_back(read(board));
    }
}

/// Makes a board of the class `Board` with one joint, counted from 0.
template <class Board, class Codec>
BusBoard one_joint(Codec codec, int joint) {
    return {AnyBoard(std::make_unique<Board>(std::move(codec))), {joint, hal::unused_joint}};
}

} // namespace dfdyn::tools
