// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A constant of an effect's column.
struct EffectConstant {
    const char* name; ///< name in a model file, and of the member of the firmware type's constants
    double EffectModel::*value;
    bool positive;
    bool always_stored; ///< stored for every effect in a model file, as 0 if the effect does not have it
};

/// The quantity that bounds the magnitude of an effect's parameter.
enum class ParameterSize {
    effort,              ///< of the joint (N·m, N)
    effort_per_velocity, ///< of the joint (N·m·s/rad, N·s/m)
    inertia,             ///< of the robot about the joint (kg·m², kg)
    weight,              ///< of the robot, on an axis of the wrench (N, N·m)
};

/// An effect that can be a column of the physics: the firmware's type and the parameter.
struct EffectKind {
    const char* name;          ///< as in a model file and a diagnosis
    const char* firmware_type; ///< template over the number of columns
    int identity;              ///< identity of the firmware's type
    const char* parameter;     ///< name and unit of the parameter
    const char* unit;
    bool at_joint = true; ///< acts on a joint, so that the outputs must be torques
    ParameterSize size = ParameterSize::effort;
    double expected_share = 1; ///< standard deviation of the parameter's prior, in units of its size
    std::span<const EffectConstant> constants = {};
    /// Returns the function that the parameter multiplies, for an effect whose constants only a diagnosis can
    /// identify. Null for effects that training can add at every joint.
    std::string (*found_shape)(const EffectModel& effect) = nullptr;

    bool has(double EffectModel::*constant) const;
    bool needs_diagnosis() const { return found_shape != nullptr; }
};

/// All kinds. To add one, add an entry in effects.cpp and a declaration here.
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

/// Returns the names of all kinds, in the order of the columns, for a message.
std::string effect_names();

/// Returns the names of the kinds that training can add.
std::string trainable_effect_names();

/// Returns the kind with this name, or null for an unknown name.
const EffectKind* find_effect_kind(const std::string& name);

/// Returns the kind with this name. Throws InputError for an unknown name.
const EffectKind& effect_kind(const std::string& name);

/// Returns the kind of an offset of the chain's outputs: `ft_bias` for a wrench, `torque_offset` otherwise.
const EffectKind& offset_kind(const ChainModel& chain);

/// Returns the v of dry friction's sign tanh(qd / v), rad/s (m/s), from the first effect that has one.
std::optional<double> sign_velocity_of(std::span<const EffectModel> effects);

/// Returns `effects` in the order of the physics' columns.
std::vector<EffectModel> in_column_order(std::vector<EffectModel> effects);

} // namespace dfdyn::tools
