// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/text.hpp"
#include "tools/model/effects.hpp"
#include "tools/model/file/model_json.hpp"
#include "tools/model/run_time/host_model.hpp"
#include "tools/model/structure.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

using nlohmann::ordered_json;

constexpr int largest_effect_count = 1000;
constexpr double largest_axis_error = 1e-4;

// Geometry is stored in double precision, because training and reports use it.

ordered_json frame_to_json(const ChainModel::Frame& frame) {
    return {{"rotation", frame.rotation}, {"translation_m", frame.translation}};
}

ordered_json chain_to_json(const ChainModel& chain) {
    ordered_json joints = ordered_json::array();
    for (const ChainModel::Joint& joint : chain.joints) {
        joints.push_back({{"name", joint.name},
                          {"prismatic", joint.prismatic},
                          {"axis", joint.axis},
                          {"placement", frame_to_json(joint.placement)}});
    }
    ordered_json json{{"joints", joints}, {"gravity", chain.gravity}};
    if (chain.sensor) {
        json["sensor"] = {{"joint", chain.sensor->joint},
                          {"link", chain.sensor->link},
                          {"parent_to_child", chain.sensor->parent_to_child},
                          {"placement", frame_to_json(chain.sensor->placement)}};
    }
    return json;
}

ordered_json effects_to_json(const std::vector<EffectModel>& effects) {
    ordered_json json = ordered_json::array();
    for (const EffectModel& effect : effects) {
        ordered_json entry{{"effect", effect.name},
                           {"row", effect.row},
                           {"sign_velocity", single(effect.sign_velocity)},
                           {"stribeck_velocity", single(effect.stribeck_velocity)}};
        for (const EffectConstant& constant : effect_kind(effect.name).constants) {
            entry[constant.name] = single(effect.*constant.value);
        }
        json.push_back(std::move(entry));
    }
    return json;
}

template <std::size_t count>
std::array<double, count> array_of(const JsonReader& reader, const char* name) {
    const std::vector<double> numbers = reader.numbers(name, static_cast<int>(count));
    std::array<double, count> result{};
    std::ranges::copy(numbers, result.begin());
    return result;
}

ChainModel::Frame read_frame(const JsonReader& reader) {
    const ChainModel::Frame frame{array_of<9>(reader, "rotation"), array_of<3>(reader, "translation_m")};
    const Eigen::Map<const Eigen::Matrix3d> rotation(frame.rotation.data());
    if (!rotation.isUnitary(largest_axis_error) || rotation.determinant() < 0) {
        throw reader.error("rotation", "a rotation matrix", "another matrix");
    }
    return frame;
}

ChainModel::Joint read_joint(const JsonReader& reader) {
    ChainModel::Joint joint{reader.text("name"), read_frame(reader.object("placement")),
                            array_of<3>(reader, "axis"), reader.flag("prismatic")};
    const double length = std::hypot(joint.axis[0], joint.axis[1], joint.axis[2]);
    if (std::abs(length - 1) > largest_axis_error) {
        throw reader.error("axis", "a vector of length 1", std::to_string(length));
    }
    return joint;
}

ChainModel read_chain(const JsonReader& reader, int joints) {
    ChainModel chain;
    for (const JsonReader& joint : reader.objects("joints", joints, joints)) {
        chain.joints.push_back(read_joint(joint));
    }
    chain.gravity = array_of<3>(reader, "gravity");
    if (reader.has("sensor")) {
        const JsonReader sensor = reader.object("sensor");
        chain.sensor = {sensor.text("joint"), sensor.whole_number("link", 0, joints),
                        read_frame(sensor.object("placement")), sensor.flag("parent_to_child")};
    }
    return chain;
}

EffectModel read_effect(const JsonReader& reader, const ChainModel& chain, int outputs) {
    EffectModel effect{reader.text("effect"),
                       reader.whole_number("row", 0, outputs - 1),
                       reader.number("sign_velocity"),
                       reader.number("stribeck_velocity"),
                       0,
                       0};
    const EffectKind* const kind = find_effect_kind(effect.name);
    if (kind == nullptr) {
        throw reader.error("effect", "one of " + effect_names(), in_quotes(effect.name));
    }
    const EffectKind& offset = offset_kind(chain);
    if ((kind->at_joint && chain.sensor) || (!kind->at_joint && kind != &offset)) {
        throw reader.error("effect", chain.sensor ? offset.name : "an effect on joint torques",
                           in_quotes(effect.name));
    }
    for (const EffectConstant& constant : kind->constants) {
        if (!constant.always_stored) {
            effect.*constant.value =
                constant.positive ? reader.positive_number(constant.name) : reader.number(constant.name);
        } else if (constant.positive && effect.*constant.value <= 0) {
            throw reader.error(constant.name, "a positive number", std::to_string(effect.*constant.value));
        }
    }
    return effect;
}

std::vector<EffectModel> read_effects(const JsonReader& reader, const ChainModel& chain, int outputs) {
    std::vector<EffectModel> effects;
    for (const JsonReader& effect : reader.objects("effects", 0, largest_effect_count)) {
        effects.push_back(read_effect(effect, chain, outputs));
    }
    return in_column_order(std::move(effects));
}

std::vector<int> read_selected(const JsonReader& reader, int count) {
    std::vector<int> selected;
    for (const double number : reader.numbers("selected")) {
        const int column = static_cast<int>(number);
        const int least = selected.empty() ? 0 : selected.back() + 1;
        if (static_cast<double>(column) != number || column < least || column >= count) {
            throw reader.error("selected", "ascending columns of " + std::to_string(count),
                               std::to_string(number));
        }
        selected.push_back(column);
    }
    if (selected.empty()) {
        throw reader.error("selected", "at least one column", "none");
    }
    return selected;
}

// In double precision, because large terms of the least-squares fit can cancel each other.

ordered_json rigid_body_to_json(const RigidBodyFit& fit) {
    return {{"identified", fit.identified},
            {"sign_velocity", fit.sign_velocity},
            {"output_gain", fit.output_gain},
            {"inertia", fit.inertia},
            {"friction", fit.friction}};
}

RigidBodyFit read_rigid_body(const JsonReader& reader, const ChainModel& chain, int outputs) {
    return {reader.flag("identified"), reader.positive_number("sign_velocity"),
            reader.numbers("output_gain", outputs),
            reader.numbers("inertia", inertial_parameters * body_count(chain)),
            reader.numbers("friction", 3 * outputs)};
}

} // namespace

ordered_json physics_to_json(const PhysicsModel& physics) {
    ordered_json json{{"chain", chain_to_json(physics.chain)},
                      {"motion", input_to_json(physics.motion)},
                      {"effects", effects_to_json(physics.effects)},
                      {"motion_limit", singles(physics.motion_limit)},
                      {"selected", physics.selected},
                      {"parameter_names", physics.parameter_names},
                      {"column_scale", singles(physics.column_scale)},
                      {"output_gain", singles(physics.output_gain)},
                      {"prior_variance", single(physics.prior_variance)}};
    if (physics.prior_variance > 0) {
        json["start"] = start_to_json(physics.start);
    } else {
        json["parameters"] = singles(physics.start.weights);
    }
    if (!physics.coupling.empty()) {
        json["coupling"] = singles(physics.coupling);
    }
    for (const RigidBodyFit& fit : physics.rigid_body) {
        json["rigid_body"].push_back(rigid_body_to_json(fit));
    }
    return json;
}

PhysicsModel read_physics(const JsonReader& reader, const TrainedModel& model) {
    const auto outputs = static_cast<int>(model.outputs.names.size());
    PhysicsModel physics;
    physics.chain = read_chain(reader.object("chain"), model.joints);
    if (outputs != (physics.chain.sensor ? 6 : model.joints)) {
        throw reader.error("chain", "the chain of the model's " + std::to_string(outputs) + " outputs",
                           physics.chain.sensor ? "one with a sensor" : "one without a sensor");
    }
    physics.motion = read_input(reader.object("motion"), model.joints);
    if (physics.motion.rows_per_joint != 3) {
        throw reader.error("motion", "three rows per joint", std::to_string(physics.motion.rows_per_joint));
    }
    physics.effects = read_effects(reader, physics.chain, outputs);
    physics.motion_limit = reader.positive_numbers("motion_limit", 3 * model.joints);
    physics.selected = read_selected(reader, inertial_parameters * body_count(physics.chain) +
                                                 static_cast<int>(physics.effects.size()));
    const auto columns = static_cast<int>(physics.selected.size());
    physics.parameter_names = reader.texts("parameter_names", columns);
    physics.column_scale = reader.positive_numbers("column_scale", columns);
    physics.output_gain = reader.positive_numbers("output_gain", outputs);
    if (structure_of(model).learns_parameters()) {
        physics.prior_variance = reader.positive_number("prior_variance");
        physics.start = read_start(reader.object("start"), columns, 1);
    } else {
        physics.start.weights = reader.numbers("parameters", columns);
    }
    if (structure_of(model).coupled()) {
        physics.coupling = reader.numbers("coupling", outputs * columns * 2 * model.features.count);
    }
    if (reader.has("rigid_body")) {
        for (const JsonReader& fit : reader.objects("rigid_body", 1, 2)) {
            physics.rigid_body.push_back(read_rigid_body(fit, physics.chain, outputs));
        }
    }
    return physics;
}

} // namespace dfdyn::tools
