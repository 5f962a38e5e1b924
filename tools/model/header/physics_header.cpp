// SPDX-License-Identifier: Apache-2.0
#include "tools/model/header/physics_header.hpp"

#include "tools/model/effects.hpp"
#include "tools/model/header/header_text.hpp"

namespace dfdyn::tools {

namespace {

/// Returns `{a, b}`.
std::string in_braces(const std::vector<std::string>& items) {
    std::string result("{");
    result += joined(items, ", ");
    result += '}';
    return result;
}

/// Returns a plain array: `{1.0F, 2.0F}`.
std::string array(std::span<const double> values) {
    const std::string text = braced(values);
    return text.substr(1, text.size() - 2);
}

std::string placement(const ChainModel::Frame& frame) {
    return in_braces({array(frame.rotation), array(frame.translation)});
}

std::string chain_constants(const ChainModel& chain) {
    std::vector<std::string> joints;
    for (const ChainModel::Joint& joint : chain.joints) {
        joints.push_back("{.placement = " + placement(joint.placement) + ", .axis = " + array(joint.axis) +
                         ", .prismatic = " + (joint.prismatic ? "true" : "false") + "}");
    }
    std::string output = "{}";
    if (chain.sensor) {
        output = "{.link = " + std::to_string(chain.sensor->link) +
                 ", .sensor = " + placement(chain.sensor->placement) +
                 ", .sign = " + literal(chain.sensor->parent_to_child ? 1 : -1) + "}";
    }
    return "{.joint = {{" + joined(joints, ",\n            ") +
           "}},\n        .gravity = " + array(chain.gravity) + ", .output = " + output + "}";
}

/// The columns of one kind of effect.
struct EffectColumns {
    const EffectKind* kind;
    std::vector<EffectModel> columns;

    std::vector<int> rows() const {
        std::vector<int> result;
        for (const EffectModel& column : columns) {
            result.push_back(column.row);
        }
        return result;
    }
    /// Returns `, .NAME = {{…}}`.
    std::string field(const char* name, double EffectModel::*member) const {
        std::vector<double> values;
        for (const EffectModel& column : columns) {
            values.push_back(column.*member);
        }
        return std::string(", .").append(name).append(" = ").append(braced(values));
    }
};

std::vector<EffectColumns> by_kind(const PhysicsModel& physics) {
    std::vector<EffectColumns> result;
    for (const EffectModel& effect : physics.effects) {
        const EffectKind& kind = effect_kind(effect.name);
        if (result.empty() || result.back().kind != &kind) {
            result.push_back({&kind, {}});
        }
        result.back().columns.push_back(effect);
    }
    return result;
}

std::string effect_constants(const EffectColumns& effect) {
    std::string fields = ".row = " + integers(effect.rows());
    for (const EffectConstant& constant : effect.kind->constants) {
        fields += effect.field(constant.name, constant.value);
    }
    return "{" + fields + "}";
}

} // namespace

std::string physics_type(const PhysicsModel& physics) {
    std::vector<std::string> parts{input_type(physics.motion), std::to_string(physics.selected.size())};
    for (const EffectColumns& effect : by_kind(physics)) {
        parts.push_back(type(effect.kind->firmware_type, {std::to_string(effect.columns.size())}));
    }
    return type("Physics", parts);
}

std::string physics_constants(const PhysicsModel& physics) {
    std::vector<std::string> effects;
    for (const EffectColumns& effect : by_kind(physics)) {
        effects.push_back(effect_constants(effect));
    }
    return "{.chain = " + chain_constants(physics.chain) +
           ",\n        .motion = " + input_constants(physics.motion) + ",\n        .effects = {" +
           joined(effects, ", ") + "},\n        .motion_limit = " + braced(physics.motion_limit) +
           ",\n        .selected = " + integers(physics.selected) +
           ",\n        .column_scale = " + braced(physics.column_scale) +
           ",\n        .output_gain = " + braced(physics.output_gain) + "}";
}

} // namespace dfdyn::tools
