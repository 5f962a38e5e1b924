// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/extension_parts.hpp"

#include "tools/model/effects.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

namespace dfdyn::tools {

namespace {

using How = CarriedFinding::How;

bool same_column(const EffectModel& one, const EffectModel& other) {
    return one.name == other.name && one.row == other.row && one.cycles_per_rev == other.cycles_per_rev &&
           one.phase == other.phase && one.stribeck_velocity == other.stribeck_velocity;
}

/// Coefficients go on adapting: they may be a tenth off, however well the recording determined them.
void add_column(Extension& extension, const EffectModel& effect, double value, double deviation) {
    deviation = std::max(deviation, 0.1 * std::abs(value));
    const auto same = std::ranges::find_if(
        extension.columns, [&](const ExtensionColumn& column) { return same_column(column.effect, effect); });
    if (same == extension.columns.end()) {
        extension.columns.push_back({effect, value, deviation});
    } else {
        same->value += value;
        same->deviation = std::hypot(same->deviation, deviation);
    }
}

void add_column(Extension& extension, const ChosenEffect& chosen, const EffectModel& effect,
                Eigen::Index coefficient) {
    add_column(extension, effect, chosen.coefficients[coefficient], chosen.deviations[coefficient]);
}

/// `name` on the effect's output, with the direction of motion as uncertain as the diagnosis took it.
EffectModel on_joint(const ChosenEffect& chosen, const char* name) {
    EffectModel effect;
    effect.name = name;
    effect.row = static_cast<int>(chosen.output());
    const std::string_view of_sliding(name);
    if (of_sliding == "coulomb_friction" || of_sliding == "stribeck_friction") {
        effect.sign_velocity = chosen.signals.sign_velocity[chosen.output()];
    }
    return effect;
}

How add_single(Extension& extension, const ChosenEffect& chosen, const char* name) {
    add_column(extension, chosen, on_joint(chosen, name), 0);
    return How::adapting;
}

} // namespace

Eigen::Index ChosenEffect::output() const {
    return candidate.columns[shape.columns.front()].parts.front().output;
}

Eigen::Index ChosenEffect::number() const {
    const std::size_t digits = candidate.where.find_first_of("0123456789");
    return digits == std::string::npos ? 0 : std::stol(candidate.where.substr(digits)) - 1;
}

How add_viscous(Extension& extension, const ChosenEffect& chosen) {
    return add_single(extension, chosen, "viscous_friction");
}

/// Another level to each side is a level and an offset.
How add_coulomb(Extension& extension, const ChosenEffect& chosen) {
    if (chosen.coefficients.size() == 2) {
        add_column(extension, chosen, on_joint(chosen, "torque_offset"), 1);
    }
    return add_single(extension, chosen, "coulomb_friction");
}

How add_stribeck(Extension& extension, const ChosenEffect& chosen) {
    EffectModel faded = on_joint(chosen, "stribeck_friction");
    faded.stribeck_velocity = chosen.shape.value;
    add_column(extension, chosen, faded, 1);
    return add_single(extension, chosen, "coulomb_friction");
}

How add_presliding(Extension& extension, const ChosenEffect& chosen) {
    add_single(extension, chosen, "coulomb_friction");
    return How::approximated;
}

How add_offset(Extension& extension, const ChosenEffect& chosen) {
    return add_single(extension, chosen, "torque_offset");
}

How add_rotor(Extension& extension, const ChosenEffect& chosen) {
    return add_single(extension, chosen, "rotor_inertia");
}

How add_spring(Extension& extension, const ChosenEffect& chosen) {
    add_column(extension, chosen, on_joint(chosen, "torque_offset"), 1);
    return add_single(extension, chosen, "joint_spring");
}

How add_ripple(Extension& extension, const ChosenEffect& chosen) {
    EffectModel wave = on_joint(chosen, "torque_ripple");
    wave.cycles_per_rev = chosen.shape.value;
    const double amplitude = chosen.coefficients.norm();
    for (Eigen::Index part = 0; part < 2; ++part) {
        wave.phase = part == 0 ? 0 : std::numbers::pi / 2;
        add_column(extension, wave, chosen.coefficients[part],
                   std::max(chosen.deviations[part], 0.1 * amplitude));
    }
    return How::adapting;
}

How add_bias(Extension& extension, const ChosenEffect& chosen) {
    for (Eigen::Index i = 0; i < chosen.coefficients.size(); ++i) {
        EffectModel bias;
        bias.name = "ft_bias";
        const std::size_t column = chosen.shape.columns[static_cast<std::size_t>(i)];
        bias.row = static_cast<int>(chosen.candidate.columns[column].parts.front().output);
        add_column(extension, chosen, bias, i);
    }
    return How::adapting;
}

/// Of an actuator or a sensor's axis: it multiplies all that the model has on that output.
How add_gain(Extension& extension, const ChosenEffect& chosen) {
    if (chosen.coefficients[0] < -0.9) {
        return How::left_out;
    }
    scale_output(extension, chosen.output(), 1 + chosen.coefficients[0], true);
    return How::fixed;
}

void scale_output(Extension& extension, Eigen::Index output, double factor, bool effects_too) {
    extension.output_gain[output] *= factor;
    for (ExtensionColumn& column : extension.columns) {
        if (!effects_too && column.effect.row == output) {
            column.value /= factor;
            column.deviation /= factor;
        }
    }
}

void sort_columns(Extension& extension) {
    std::vector<EffectModel> effects;
    for (const ExtensionColumn& column : extension.columns) {
        effects.push_back(column.effect);
    }
    std::vector<ExtensionColumn> sorted;
    for (const EffectModel& effect : in_column_order(std::move(effects))) {
        sorted.push_back(*std::ranges::find_if(extension.columns, [&](const ExtensionColumn& column) {
            return same_column(column.effect, effect);
        }));
    }
    extension.columns = std::move(sorted);
}

} // namespace dfdyn::tools
