// SPDX-License-Identifier: Apache-2.0
#include "tools/model/effects.hpp"

#include "dfdyn/physics/effects.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <array>

namespace dfdyn::tools {

namespace {

constexpr EffectConstant sign_velocity{"sign_velocity", &EffectModel::sign_velocity, true, true};
constexpr EffectConstant stribeck_velocity{"stribeck_velocity", &EffectModel::stribeck_velocity, true, true};

constexpr std::array of_coulomb{sign_velocity};
constexpr std::array of_stribeck{sign_velocity, stribeck_velocity};
constexpr std::array of_ripple{EffectConstant{"cycles_per_rev", &EffectModel::cycles_per_rev, true, false},
                               EffectConstant{"phase", &EffectModel::phase, false, false}};

/// Of the joint's effort limit. With larger offsets a model of one motion would explain errors of the weight
/// by offsets, which are wrong in other postures.
constexpr double offset_share = 0.005;
constexpr double rotor_share = 0.1; ///< of the robot's inertia about the joint, with the arm stretched

std::string wave(const EffectModel& effect) {
    return "sin(" + number_text(effect.cycles_per_rev) + " q + " + number_text(effect.phase) + ")";
}

} // namespace

namespace effect_kinds {

constinit const EffectKind viscous_friction{.name = "viscous_friction",
                                            .firmware_type = "ViscousFriction",
                                            .identity = ViscousFriction<1>::identity,
                                            .parameter = "viscous",
                                            .unit = "N·m·s/rad",
                                            .size = ParameterSize::effort_per_velocity};
constinit const EffectKind coulomb_friction{.name = "coulomb_friction",
                                            .firmware_type = "CoulombFriction",
                                            .identity = CoulombFriction<1>::identity,
                                            .parameter = "coulomb",
                                            .unit = "N·m",
                                            .constants = of_coulomb};
constinit const EffectKind stribeck_friction{.name = "stribeck_friction",
                                             .firmware_type = "StribeckFriction",
                                             .identity = StribeckFriction<1>::identity,
                                             .parameter = "static - coulomb",
                                             .unit = "N·m",
                                             .constants = of_stribeck};
constinit const EffectKind rotor_inertia{.name = "rotor_inertia",
                                         .firmware_type = "RotorInertia",
                                         .identity = RotorInertia<1>::identity,
                                         .parameter = "inertia",
                                         .unit = "kg·m²",
                                         .size = ParameterSize::inertia,
                                         .expected_share = rotor_share};
constinit const EffectKind joint_spring{.name = "joint_spring",
                                        .firmware_type = "JointSpring",
                                        .identity = JointSpring<1>::identity,
                                        .parameter = "stiffness",
                                        .unit = "N·m/rad"};
constinit const EffectKind torque_ripple{.name = "torque_ripple",
                                         .firmware_type = "TorqueRipple",
                                         .identity = TorqueRipple<1>::identity,
                                         .parameter = "ripple",
                                         .unit = "N·m",
                                         .constants = of_ripple,
                                         .found_shape = wave};
constinit const EffectKind torque_offset{.name = "torque_offset",
                                         .firmware_type = "OutputOffset",
                                         .identity = OutputOffset<1>::identity,
                                         .parameter = "offset",
                                         .unit = "N·m",
                                         .at_joint = false,
                                         .expected_share = offset_share};
constinit const EffectKind ft_bias{.name = "ft_bias",
                                   .firmware_type = "OutputOffset",
                                   .identity = OutputOffset<1>::identity,
                                   .parameter = "bias",
                                   .unit = "N or N·m",
                                   .at_joint = false,
                                   .size = ParameterSize::weight};

} // namespace effect_kinds

namespace {

/// In the order of the physics' columns.
constexpr std::array kinds{&effect_kinds::viscous_friction,  &effect_kinds::coulomb_friction,
                           &effect_kinds::stribeck_friction, &effect_kinds::rotor_inertia,
                           &effect_kinds::joint_spring,      &effect_kinds::torque_ripple,
                           &effect_kinds::torque_offset,     &effect_kinds::ft_bias};

std::string names_of(bool (*wanted)(const EffectKind& kind)) {
    std::string names;
    for (const EffectKind* const kind : kinds) {
        if (wanted(*kind)) {
            names.append(names.empty() ? "" : ", ").append(kind->name);
        }
    }
    return names;
}

} // namespace

bool EffectKind::has(double EffectModel::*constant) const {
    return std::ranges::find(constants, constant, &EffectConstant::value) != constants.end();
}

std::string effect_names() {
    return names_of([](const EffectKind&) { return true; });
}

std::string trainable_effect_names() {
    return names_of([](const EffectKind& kind) { return !kind.needs_diagnosis(); });
}

const EffectKind* find_effect_kind(const std::string& name) {
    const auto kind =
        std::ranges::find(kinds, name, [](const EffectKind* one) { return std::string(one->name); });
    return kind == kinds.end() ? nullptr : *kind;
}

const EffectKind& effect_kind(const std::string& name) {
    const EffectKind* const kind = find_effect_kind(name);
    if (kind == nullptr) {
        throw InputError("effect: expected one of " + effect_names() + ", found " + in_quotes(name));
    }
    return *kind;
}

const EffectKind& offset_kind(const ChainModel& chain) {
    return chain.sensor ? effect_kinds::ft_bias : effect_kinds::torque_offset;
}

std::optional<double> sign_velocity_of(std::span<const EffectModel> effects) {
    const auto dry = std::ranges::find_if(effects, [](const EffectModel& effect) {
        return effect_kind(effect.name).has(&EffectModel::sign_velocity);
    });
    return dry == effects.end() ? std::nullopt : std::optional(dry->sign_velocity);
}

std::vector<EffectModel> in_column_order(std::vector<EffectModel> effects) {
    std::ranges::stable_sort(effects, {}, [](const EffectModel& effect) {
        return std::pair(std::ranges::find(kinds, &effect_kind(effect.name)), effect.row);
    });
    return effects;
}

} // namespace dfdyn::tools
