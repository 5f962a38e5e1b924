// SPDX-License-Identifier: Apache-2.0
#include "tools/model/header/model_header.hpp"

#include "tools/base/text/number.hpp"
#include "tools/model/effects.hpp"
#include "tools/model/header/header_text.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/model/run_time/contact_constants.hpp"
#include "tools/model/run_time/host_model.hpp"
#include "tools/model/structure.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>
#include <string_view>
#include <type_traits>
#include <variant>

namespace dfdyn::tools {

namespace {

/// Returns `text` as one line of printable characters for a comment, for any file name.
std::string comment(std::string_view text) {
    std::string result;
    for (const char c : text) {
        result += std::isprint(static_cast<unsigned char>(c)) != 0 && c != '\\' ? c : '?';
    }
    return result;
}

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

std::string learned_type(const Structure& structure) { return type(structure.firmware_type, {"Physics"}); }

std::string model_type(const TrainedModel& model) {
    const std::string arm =
        model.physics
            ? arm_type(model.physics->chain)
            : type("Joints", {std::to_string(model.joints), std::to_string(model.outputs.names.size())});
    const Structure& structure = structure_of(model);
    if (!structure.features) {
        return type("Model", {"float", arm, "dfdyn::NoInput", "dfdyn::NoFeatures", learned_type(structure)});
    }
    std::vector<std::string> parts{"float", arm, input_type(model.input),
                                   type("RandomFourier", {std::to_string(model.features.count)})};
    if (model.physics) {
        parts.push_back(learned_type(structure));
    }
    return type("Model", parts);
}

/// `Input`: a constants object of AnyInput, or of NoInput.
template <class Input>
std::string input_constants(const Input& input) {
    if constexpr (std::is_empty_v<Input>) {
        return "{}";
    } else {
        return std::visit(
            [](const auto& own) {
                std::string fields;
                if constexpr (requires { own.position_noise_bound; }) {
                    fields += ".position_noise_bound = " + literal(own.position_noise_bound) + ",\n        ";
                }
                if constexpr (requires { own.rows; }) {
                    fields += ".rows = " + literal(own.rows) + ",\n        ";
                }
                return "{" + fields + ".scale = " + literal(own.scale) + "}";
            },
            input);
    }
}

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

/// Returns the definition of a constant with the initial state of a learner.
template <int m>
std::string start_constant(const char* name, const LearnerStart<float, dynamic, m>& start) {
    const int columns = start.diagonal.size();
    return "inline constexpr " +
           type("LearnerStart",
                {"float", std::to_string(columns), std::to_string(start.weights.size() / columns)}) +
           " " + name + "{\n    .weights = " + literal(start.weights) +
           ",\n    .unit_upper = " + literal(start.unit_upper) +
           ",\n    .diagonal = " + literal(start.diagonal) + "};\n\n";
}

std::string learner(const auto& constants, const char* start) {
    return "{.prior_variance = " + literal(constants.prior_variance) +
           ", .forgetting_factor = " + literal(constants.forgetting_factor) + ", .start = &" + start + "}";
}

/// Returns the constants of the learner, or of both learners, of a structure.
template <class Model>
std::string learner_constants(const typename Model::StructureConstants& constants) {
    if constexpr (requires { constants.common; }) {
        return "{.features = " + learner(constants.features, "start") +
               ", .common = " + learner(constants.common, "parameter_start") + "}";
    } else if constexpr (requires { constants.residual; }) {
        return "{.parameters_of_mean = " + literal(constants.parameters_of_mean) +
               ",\n        .residual = " + learner(constants.residual, "start") + "}";
    } else {
        return learner(constants, Model::columns == 0 ? "parameter_start" : "start");
    }
}

template <class Features>
std::string feature_constants(const Features& features) {
    if constexpr (std::is_empty_v<Features>) {
        return "{}";
    } else {
        return "{.frequencies = " + literal(features.frequencies) +
               ",\n        .amplitude = " + literal(features.amplitude) + "}";
    }
}

/// Returns the initializers of the members that a model may lack.
template <class Constants>
std::string extrapolation_constants(const TrainedModel& model, const Constants& constants) {
    if (!model.extrapolation) {
        return "";
    }
    const auto& known = constants.extrapolation;
    std::string text =
        ",\n    .extrapolation = {.inverse_far_variance = " + literal(known.inverse_far_variance) +
        ",\n        .extra_noise = " + literal(known.extra_noise) +
        ",\n        .prior_variance = " + literal(known.prior_variance);
    if (!model.extrapolation->output_variance.empty()) {
        text += ",\n        .parameter_variance_factor = " + literal(known.parameter_variance_factor) +
                ",\n        .output_variance = " + literal(known.output_variance);
    }
    return text + "}";
}

/// Prints the constants of the run-time model, so that the firmware gets the numbers that the program uses.
template <class Model>
std::string constants_text(const TrainedModel& model) {
    const auto host = make_host_constants<Model>(model, false);
    const typename Model::Constants& constants = host->constants;
    std::string text;
    if (Model::columns != 0) {
        text += start_constant("start", host->features);
    }
    if (structure_of(model).learns_parameters()) {
        text += start_constant("parameter_start", host->parameters);
    }
    std::string physics = "{}";
    if constexpr (!std::is_same_v<typename Model::Physics, NoPhysics>) {
        physics = physics_constants<typename Model::Arm>(constants.physics);
    }
    const bool limited = !model.limits.prediction.empty();
    return text + "inline constexpr Model::Constants constants{\n    .sizes = {},\n    .identity = " +
           std::to_string(constants.identity) + "U,\n    .gap_ns = " + std::to_string(constants.gap_ns) +
           ",\n    .period_ns = " + std::to_string(constants.period_ns) +
           ",\n    .input = " + input_constants(constants.input) +
           ",\n    .features = " + feature_constants(constants.features) + ",\n    .physics = " + physics +
           ",\n    .output_offset = " + literal(constants.output_offset) +
           ",\n    .output_noise_std = " + literal(constants.output_noise_std) +
           ",\n    .position_limit = " + literal(constants.position_limit) +
           ",\n    .output_limit = " + literal(constants.output_limit) +
           ",\n    .innovation_limit = " + literal(constants.innovation_limit) +
           ",\n    .innovation_patience = " + std::to_string(constants.innovation_patience) +
           (limited ? ",\n    .prediction_limit = " + literal(constants.prediction_limit) : "") +
           ",\n    .learner = " + learner_constants<Model>(constants.learner) +
           extrapolation_constants(model, constants) + "};\n\n";
}

/// Returns whether `name` cannot be a namespace: it is a keyword of C++20, or a name that the header uses.
bool is_taken(std::string_view name) {
    static constexpr auto taken = std::to_array<std::string_view>(
        {"alignas",   "alignof",       "and",         "and_eq",       "asm",
         "auto",      "bitand",        "bitor",       "bool",         "break",
         "case",      "catch",         "char",        "char16_t",     "char32_t",
         "char8_t",   "class",         "co_await",    "co_return",    "co_yield",
         "compl",     "concept",       "const",       "const_cast",   "consteval",
         "constexpr", "constinit",     "continue",    "decltype",     "default",
         "delete",    "dfdyn",         "do",          "double",       "dynamic_cast",
         "else",      "enum",          "explicit",    "export",       "extern",
         "false",     "float",         "for",         "friend",       "goto",
         "if",        "inline",        "int",         "long",         "main",
         "mutable",   "namespace",     "new",         "noexcept",     "not",
         "not_eq",    "nullptr",       "operator",    "or",           "or_eq",
         "private",   "protected",     "public",      "register",     "reinterpret_cast",
         "requires",  "return",        "short",       "signed",       "sizeof",
         "static",    "static_assert", "static_cast", "std",          "struct",
         "switch",    "template",      "this",        "thread_local", "throw",
         "true",      "try",           "typedef",     "typeid",       "typename",
         "union",     "unsigned",      "using",       "virtual",      "void",
         "volatile",  "wchar_t",       "while",       "xor",          "xor_eq"});
    return std::ranges::find(taken, name) != taken.end();
}

std::string contact_text(const ContactModel& contact) {
    const std::vector<ContactLimits<float>> joints = contact_constants(contact);
    if (joints.empty()) {
        return "";
    }
    std::string text = "/// For a dfdyn::ContactDetector, with " + number_text(contact_rate_per_hour) +
                       " false contacts per hour.\n" +
                       "inline constexpr dfdyn::ContactLimits<float> contact_limits[] = {";
    const char* separator = "\n";
    for (const ContactLimits<float>& joint : joints) {
        text += separator + ("    {.limit = " + array(joint.limit)) + ", .usual = " + literal(joint.usual) +
                ", .relative = " + literal(joint.relative) + ", .speed = " + literal(joint.speed) +
                ", .acceleration = " + literal(joint.acceleration) +
                ", .standard_deviation = " + literal(joint.standard_deviation) +
                ", .hysteresis = " + literal(joint.hysteresis) + "}";
        separator = ",\n";
    }
    return text + "};\n\n";
}

} // namespace

std::string to_identifier(const std::string& stem) {
    std::string result;
    for (const char c : stem) {
        result += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
    }
    const bool usable = !result.empty() && std::isalpha(static_cast<unsigned char>(result.front())) != 0;
    return !usable ? "model_" + result : is_taken(result) ? result + "_" : result;
}

std::string model_to_header(const TrainedModel& model, const std::string& name_space) {
    std::ostringstream header;
    header << "// Written by `dfdyn train`; do not edit. Outputs: "
           << comment(joined(model.outputs.names, " ")) << ".\n"
           << "// Trained on " << comment(joined(model.training.recordings, " ")) << ", rows "
           << comment(model.training.rows) << ", sampled every " << model.sample_period_s << " s.\n"
           << "// clang-format off\n#pragma once\n\n#include \"dfdyn/dfdyn.hpp\"\n\nnamespace " << name_space
           << " {\n\n";
    if (model.physics) {
        header << "using Physics = " << physics_type(*model.physics) << ";\n\n";
    }
    header << "using Model = " << model_type(model) << ";\n\n"
           << with_host_type(model,
                             [&]<class Model>(std::type_identity<Model> /*type*/) {
                                 return constants_text<Model>(model);
                             })
           << contact_text(model.contact) << "} // namespace " << name_space << "\n";
    return header.str();
}

} // namespace dfdyn::tools
