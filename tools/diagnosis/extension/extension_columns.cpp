// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/extension/extension_parts.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

bool same_column(const EffectModel& one, const EffectModel& other) {
    return one.name == other.name && one.row == other.row && one.cycles_per_rev == other.cycles_per_rev &&
           one.phase == other.phase && one.stribeck_velocity == other.stribeck_velocity;
}

} // namespace

Eigen::Index ChosenEffect::output() const {
    return candidate.columns[shape.columns.front()].parts.front().output;
}

Eigen::Index ChosenEffect::number() const {
    return static_cast<Eigen::Index>(numbered_place(candidate.where).value().index);
}

EffectModel on_joint(const ChosenEffect& chosen, const EffectKind& kind) {
    EffectModel effect;
    effect.name = kind.name;
    effect.row = static_cast<int>(chosen.output());
    if (kind.has(&EffectModel::sign_velocity)) {
        effect.sign_velocity = chosen.signals.sign_velocity[chosen.output()];
    }
    return effect;
}

void add_column(ModelExtension& extension, const EffectModel& effect, double value, double deviation) {
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

void add_column(ModelExtension& extension, const ChosenEffect& chosen, const EffectModel& effect,
                Eigen::Index coefficient) {
    add_column(extension, effect, chosen.coefficients[coefficient], chosen.deviations[coefficient]);
}

EffectDisposition add_single(ModelExtension& extension, const ChosenEffect& chosen, const EffectKind& kind) {
    add_column(extension, chosen, on_joint(chosen, kind), 0);
    return EffectDisposition::adapting;
}

EffectDisposition add_gain(ModelExtension& extension, const ChosenEffect& chosen) {
    if (chosen.coefficients[0] < -0.9) {
        return EffectDisposition::left_out;
    }
    scale_output(extension, chosen.output(), 1 + chosen.coefficients[0], true);
    return EffectDisposition::fixed;
}

void scale_output(ModelExtension& extension, Eigen::Index output, double factor, bool effects_too) {
    extension.output_gain[output] *= factor;
    for (ExtensionColumn& column : extension.columns) {
        if (!effects_too && column.effect.row == output) {
            column.value /= factor;
            column.deviation /= factor;
        }
    }
}

void sort_columns(ModelExtension& extension) {
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
