// SPDX-License-Identifier: Apache-2.0
#include "tools/model/effects.hpp"

#include "tools/common/error.hpp"
#include "tools/common/text.hpp"

#include <algorithm>
#include <array>

namespace dfdyn::tools {

namespace {

constexpr std::array<EffectKind, 8> kinds{
    {{"viscous_friction", "ViscousFriction", "viscous", "N·m·s/rad", true},
     {"coulomb_friction", "CoulombFriction", "coulomb", "N·m", true},
     {"stribeck_friction", "StribeckFriction", "static - coulomb", "N·m", true},
     {"rotor_inertia", "RotorInertia", "inertia", "kg·m²", true},
     {"joint_spring", "JointSpring", "stiffness", "N·m/rad", true},
     {"torque_ripple", "TorqueRipple", "ripple", "N·m", true},
     {"torque_offset", "OutputOffset", "offset", "N·m", false},
     {"ft_bias", "OutputOffset", "bias", "N or N·m", false}}};

} // namespace

std::string effect_names() {
    std::string names;
    for (const EffectKind& kind : kinds) {
        names.append(names.empty() ? "" : ", ").append(kind.name);
    }
    return names;
}

const EffectKind* find_effect_kind(const std::string& name) {
    const auto* const kind =
        std::ranges::find(kinds, name, [](const EffectKind& one) { return std::string(one.name); });
    return kind == kinds.end() ? nullptr : kind;
}

const EffectKind& effect_kind(const std::string& name) {
    const EffectKind* const kind = find_effect_kind(name);
    if (kind == nullptr) {
        throw InputError("effect: expected one of " + effect_names() + ", found " + in_quotes(name));
    }
    return *kind;
}

const char* offset_effect(const ChainModel& chain) { return chain.sensor ? "ft_bias" : "torque_offset"; }

std::vector<EffectModel> in_column_order(std::vector<EffectModel> effects) {
    std::ranges::stable_sort(effects, {}, [](const EffectModel& effect) {
        return std::pair(&effect_kind(effect.name) - kinds.data(), effect.row);
    });
    return effects;
}

} // namespace dfdyn::tools
