// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/families/family_fields.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dfdyn::tools {

/// Names of the fields of the three maxima.
inline constexpr std::array<const char*, 3> maximum_names{"position_max", "velocity_max", "torque_max"};

/// Reads `motor` and the three maxima. A maximum without a field is taken from the motor's type. `expected`:
/// expected text in errors about missing maxima.
Maxima read_maxima(const JsonReader& board, std::span<const MotorType> types,
                   const std::array<std::string, 3>& expected);

/// Marks the motors that share an answer identifier, if their numbers distinguish them. Throws InputError for
/// two motors with one number on one identifier, and for answers on an identifier of commands.
template <class Config>
void share_feedback_ids(const JsonReader& joints, bool own_id, std::vector<Config>& configs) {
    for (std::size_t i = 0; i < configs.size(); ++i) {
        for (std::size_t k = 0; k < configs.size(); ++k) {
            const bool same_id = i != k && configs[i].feedback_id == configs[k].feedback_id;
            if (same_id && configs[i].motor_id == configs[k].motor_id) {
                throw joints.error("boards", "motors that differ in motor_id or feedback_id",
                                   "two with motor_id " + std::to_string(configs[i].motor_id) + " on " +
                                       identifier_text(configs[i].feedback_id));
            }
            configs[i].shared_feedback_id = configs[i].shared_feedback_id || same_id;
            const bool own = i == k && own_id;
            if (!own && configs[i].feedback_id == static_cast<std::uint32_t>(configs[k].motor_id)) {
                throw joints.error("boards", "answers on identifiers that no motor is commanded on",
                                   "answers on " + identifier_text(configs[i].feedback_id) +
                                       ", which is motor_id " + std::to_string(configs[k].motor_id));
            }
        }
    }
}

/// Adds the motors with MIT mode whose configuration `read(board)` returns. `own_id`: see share_feedback_ids.
template <class MitBoard, class Codec, class Read>
void add_mit_motors(const JsonReader& joints, bool own_id, Read read, BusDescription& description) {
    std::vector<typename Codec::Config> configs;
    for (const JsonReader& board : joints.objects("boards", 1, largest_bus_joint_count)) {
        configs.push_back(read(board));
    }
    share_feedback_ids(joints, own_id, configs);
    for (const typename Codec::Config& config : configs) {
        description.boards.push_back(one_joint<MitBoard>(Codec(config), config.joint));
    }
}

/// Reads `newton_metre_per_ampere`; 0 without.
double read_torque_constant(const JsonReader& board);

/// Common fields of all motors. `angle`: the position that the transmission relates to the joint's.
FamilyField transmission_field();
FamilyField zero_field();

} // namespace dfdyn::tools
