// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// An effect that can be a column of the physics: the firmware's type and what its parameter is.
struct EffectKind {
    const char* name;          ///< as in a model file and a diagnosis
    const char* firmware_type; ///< template over the number of columns
    const char* parameter;     ///< its name and unit
    const char* unit;
    bool at_joint; ///< acts on a joint: the outputs must be torques
};

/// The names of all of them, in the order of the columns, for a message.
std::string effect_names();

/// Null for a name that is none of them.
const EffectKind* find_effect_kind(const std::string& name);

/// Throws InputError for a name that is none of them.
const EffectKind& effect_kind(const std::string& name);

/// The name of an offset of the chain's outputs: `ft_bias` of a wrench, `torque_offset` otherwise.
const char* offset_effect(const ChainModel& chain);

/// `effects` in the order of the physics' columns.
std::vector<EffectModel> in_column_order(std::vector<EffectModel> effects);

} // namespace dfdyn::tools
