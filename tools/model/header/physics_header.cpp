// SPDX-License-Identifier: Apache-2.0
#include "tools/model/header/physics_header.hpp"

#include "tools/model/effects.hpp"
#include "tools/model/header/header_text.hpp"
#include "tools/model/inputs/input_description.hpp"

#include <algorithm>

namespace dfdyn::tools {

namespace {

std::string placement(const Placement<float>& pose) {
    return "{" + array(pose.rotation) + ", " + array(pose.translation) + "}";
}

std::string sensor_constants(const JointTorques::Constants<float>& /*output*/) { return "{}"; }
std::string sensor_constants(const WrenchAtSensor<dynamic>::Constants<float>& output) {
    return "{.link = " + std::to_string(output.link) + ", .sensor = " + placement(output.sensor) +
           ", .sign = " + literal(output.sign) + "}";
}

template <class Constants>
std::string effect_constants(const Constants& effect) {
    std::string fields = ".row = " + literal(effect.row);
    for_each_constant(effect, [&](const char* name, const auto& values, double EffectModel::* /*member*/) {
        fields.append(", .").append(name).append(" = ").append(literal(values));
    });
    return "{" + fields + "}";
}

/// Returns the constants of the effects that have columns.
template <class Motion, int p, class... Effects>
std::string effects_constants(Physics<Motion, p, Effects...> /*of*/,
                              const HostPhysics::EffectConstants<float>& effects) {
    std::vector<std::string> texts;
    const auto add = [&](const auto& effect) {
        if (effect.row.size() > 0) {
            texts.push_back(effect_constants(effect));
        }
    };
    (add(static_cast<const typename Effects::template Constants<float>&>(effects)), ...);
    return "{" + joined(texts, ", ") + "}";
}

} // namespace

std::string input_type(const InputModel& input) {
    return "dfdyn::" + input_description(input.kind).firmware_type(input);
}

std::string arm_type(const ChainModel& chain) {
    return type("Chain", {std::to_string(chain.joints.size()),
                          chain.sensor ? type("WrenchAtSensor", {std::to_string(body_count(chain))})
                                       : "dfdyn::JointTorques"});
}

std::string physics_type(const PhysicsModel& physics) {
    std::vector<std::string> parts{input_type(physics.motion), std::to_string(physics.selected.size())};
    for (auto first = physics.effects.begin(); first != physics.effects.end();) {
        const EffectKind& kind = effect_kind(first->name);
        const auto next = std::find_if(first, physics.effects.end(), [&](const EffectModel& effect) {
            return &effect_kind(effect.name) != &kind;
        });
        parts.push_back(type(kind.firmware_type, {std::to_string(next - first)}));
        first = next;
    }
    return type("Physics", parts);
}

template <class Arm>
std::string chain_constants(const typename Arm::template Constants<float>& chain) {
    std::vector<std::string> joints;
    for (const ChainJoint<float>& joint : chain.joint) {
        joints.push_back("{.placement = " + placement(joint.placement) + ", .axis = " + array(joint.axis) +
                         ", .prismatic = " + (joint.prismatic ? "true" : "false") + "}");
    }
    return "{.joint = {{" + joined(joints, ",\n            ") +
           "}},\n        .gravity = " + array(chain.gravity) +
           ", .output = " + sensor_constants(chain.output) + "}";
}

template <class Arm>
std::string physics_constants(const typename HostPhysics::template Constants<float, Arm>& physics) {
    return "{.chain = " + chain_constants<Arm>(physics.chain) +
           ",\n        .motion = " + input_constants(physics.motion) +
           ",\n        .effects = " + effects_constants(HostPhysics{}, physics.effects) +
           ",\n        .motion_limit = " + literal(physics.motion_limit) +
           ",\n        .selected = " + literal(physics.selected) +
           ",\n        .column_scale = " + literal(physics.column_scale) +
           ",\n        .output_gain = " + literal(physics.output_gain) + "}";
}

template std::string chain_constants<TorqueArm>(const TorqueArm::Constants<float>&);
template std::string chain_constants<WrenchArm>(const WrenchArm::Constants<float>&);
template std::string physics_constants<TorqueArm>(const HostPhysics::Constants<float, TorqueArm>&);
template std::string physics_constants<WrenchArm>(const HostPhysics::Constants<float, WrenchArm>&);

} // namespace dfdyn::tools
