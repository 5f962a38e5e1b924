// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A constant of an effect's column.
struct EffectConstant {
    const char* name; ///< in a model file, and of the member of the firmware type's constants
    double EffectModel::*value;
    bool positive;
    bool always_stored; ///< in the model files' entries of all effects, 0 where an effect does not have it
};

/// What bounds the magnitude of an effect's parameter.
enum class ParameterSize {
    effort,              ///< of the joint (N·m, N)
    effort_per_velocity, ///< of the joint (N·m·s/rad, N·s/m)
    inertia,             ///< of the robot about the joint (kg·m², kg)
    weight,              ///< of the robot, on an axis of the wrench (N, N·m)
};

/// An effect that can be a column of the physics: the firmware's type and its parameter.
struct EffectKind {
    const char* name;          ///< as in a model file and a diagnosis
    const char* firmware_type; ///< template over the number of columns
    int identity;              ///< of the firmware's type
    const char* parameter;     ///< its name; its unit
    const char* unit;
    bool at_joint = true; ///< acts on a joint: the outputs must be torques
    ParameterSize size = ParameterSize::effort;
    std::span<const EffectConstant> constants = {};
    /// The function that the parameter multiplies, for an effect whose constants only a diagnosis finds. Null
    /// for others, which training can have at every joint.
    std::string (*found_shape)(const EffectModel& effect) = nullptr;

    bool has(double EffectModel::*constant) const;
    bool needs_diagnosis() const { return found_shape != nullptr; }
};

/// All kinds. A new one is an entry in effects.cpp and a line here.
namespace effect_kinds {

extern const EffectKind viscous_friction;
extern const EffectKind coulomb_friction;
extern const EffectKind stribeck_friction;
extern const EffectKind rotor_inertia;
extern const EffectKind joint_spring;
extern const EffectKind torque_ripple;
extern const EffectKind torque_offset;
extern const EffectKind ft_bias;

} // namespace effect_kinds

/// The names of all of them, in the order of the columns, for a message.
std::string effect_names();

/// Of those that training can have.
std::string trainable_effect_names();

/// Null for a name that is none of them.
const EffectKind* find_effect_kind(const std::string& name);

/// Throws InputError for a name that is none of them.
const EffectKind& effect_kind(const std::string& name);

/// An offset of the chain's outputs: `ft_bias` of a wrench, `torque_offset` otherwise.
const EffectKind& offset_kind(const ChainModel& chain);

/// `effects` in the order of the physics' columns.
std::vector<EffectModel> in_column_order(std::vector<EffectModel> effects);

} // namespace dfdyn::tools
