// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/description/bus_fields.hpp"
#include "tools/can/families/family.hpp"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Readers of fields that several families have. Errors as of JsonReader.

/// The names of a family's fields, for JsonReader::allow_only.
std::vector<std::string_view> names_of(const std::vector<FamilyField>& fields);

/// `joint`, of a board with one: from 1 in the file, from 0 here.
int read_joint(const JsonReader& board);

/// Counts, ticks or turns per something: negative for the other direction, never 0.
double read_ratio(const JsonReader& reader, const std::string& name);
double read_ratio(double value, const JsonReader& reader, const std::string& name);
double ratio_or(const JsonReader& reader, const std::string& name, double absent);

/// `zero_rad` (0): the joint's position where the encoder shows 0.
double read_zero_rad(const JsonReader& board);

/// `limit`: ± per axis.
std::array<double, 6> read_limit(const JsonReader& output);
/// Without the field, those of an axis of force and of torque.
std::array<double, 6> limit_or(const JsonReader& output, double force, double torque);

/// Adds `read(board)`, a BusBoard, of each entry of `boards`.
template <class Read>
void read_each_board(const JsonReader& joints, Read read, BusDescription& description) {
    for (const JsonReader& board : joints.objects("boards", 1, largest_bus_joint_count)) {
        description.boards.push_back(read(board));
    }
}

/// A board of the class `Board` with one joint, from 0.
template <class Board, class Codec>
BusBoard one_joint(Codec codec, int joint) {
    return {AnyBoard(std::make_unique<Board>(std::move(codec))), {joint, hal::unused_joint}};
}

} // namespace dfdyn::tools
