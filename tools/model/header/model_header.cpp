// SPDX-License-Identifier: Apache-2.0
#include "tools/model/header/model_header.hpp"

#include "tools/model/file/model_file.hpp"
#include "tools/model/header/header_text.hpp"
#include "tools/model/header/physics_header.hpp"
#include "tools/model/run_time/host_model.hpp"
#include "tools/model/structure.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <span>
#include <sstream>
#include <string_view>

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

std::string arm_type(const TrainedModel& model) {
    const std::string joints = std::to_string(model.joints);
    if (!model.physics) {
        return type("Joints", {joints, std::to_string(model.outputs.names.size())});
    }
    return type("Chain",
                {joints, model.physics->chain.sensor
                             ? type("WrenchAtSensor", {std::to_string(body_count(model.physics->chain))})
                             : "dfdyn::JointTorques"});
}

std::string learned_type(const Structure& structure) { return type(structure.firmware_type, {"Physics"}); }

std::string model_type(const TrainedModel& model) {
    const std::string arm = arm_type(model);
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

std::string feature_constants(const TrainedModel& model) {
    return "{.frequencies = " +
           braced(firmware_frequencies(model.features, model.joints * model.input.rows_per_joint)) +
           ",\n        .amplitude = " + literal(1 / std::sqrt(static_cast<double>(model.features.count))) +
           "}";
}

/// Returns the definition of a constant with the initial state of a learner with `outputs` outputs.
std::string start_constant(const char* name, const StartModel& start, const std::vector<double>& weights,
                           std::size_t outputs) {
    return "inline constexpr " +
           type("LearnerStart", {"float", std::to_string(start.diagonal.size()), std::to_string(outputs)}) +
           " " + name + "{\n    .weights = " + braced(weights) +
           ",\n    .unit_upper = " + braced(start.unit_upper) +
           ",\n    .diagonal = " + braced(start.diagonal) + "};\n\n";
}

std::string starts(const TrainedModel& model) {
    std::string result;
    if (structure_of(model).features) {
        const std::vector<double> weights = firmware_weights(model);
        result += start_constant("start", model.start, weights, weights.size() / model.start.diagonal.size());
    }
    if (structure_of(model).learns_parameters()) {
        const StartModel& start = model.physics->start;
        result += start_constant("parameter_start", start, start.weights, 1);
    }
    return result;
}

std::string learner(double prior_variance, double forgetting_factor, const char* start) {
    return "{.prior_variance = " + literal(prior_variance) +
           ", .forgetting_factor = " + literal(forgetting_factor) + ", .start = &" + start + "}";
}

std::string learner_constants(const TrainedModel& model) {
    const auto features = [&] {
        return learner(model.outputs.prior_variance, model.forgetting_factor, "start");
    };
    if (!model.physics) {
        return features();
    }
    if (model.physics->prior_variance <= 0) {
        return "{.parameters_of_mean = " + braced(model.physics->start.weights) +
               ",\n        .residual = " + features() + "}";
    }
    const std::string parameters =
        learner(model.physics->prior_variance, model.forgetting_factor, "parameter_start");
    return !structure_of(model).features ? parameters
                                         : "{.features = " + features() + ", .common = " + parameters + "}";
}

/// Returns the initializer of the prediction limits; empty if the model has none.
std::string prediction_limit(const LimitModel& limits) {
    return limits.prediction.empty() ? "" : ",\n    .prediction_limit = " + braced(limits.prediction);
}

std::string extrapolation_constants(const TrainedModel& model) {
    if (!model.extrapolation) {
        return "";
    }
    const ExtrapolationModel& known = *model.extrapolation;
    std::string text =
        ",\n    .extrapolation = {.inverse_far_variance = " + literal(known.inverse_far_variance) +
        ",\n        .extra_noise = " + braced(known.extra_noise) +
        ",\n        .prior_variance = " + braced(known.prior_variance);
    if (!known.output_variance.empty()) {
        text += ",\n        .parameter_variance_factor = " + literal(known.parameter_variance_factor) +
                ",\n        .output_variance = " + braced(known.output_variance);
    }
    return text + "}";
}

} // namespace

std::string to_identifier(const std::string& stem) {
    std::string result;
    for (const char c : stem) {
        result += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
    }
    const bool usable = !result.empty() && std::isalpha(static_cast<unsigned char>(result.front())) != 0;
    return usable ? result : "model_" + result;
}

std::string model_to_header(const TrainedModel& model, const std::string& name_space) {
    const bool features = structure_of(model).features;
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
           << starts(model)
           << "inline constexpr Model::Constants constants{\n    .sizes = {},\n    .identity = "
           << model_identity(model) << "U,\n    .gap_ns = " << gap_ns(model)
           << ",\n    .period_ns = " << std::llround(1e9 * model.sample_period_s)
           << ",\n    .input = " << (features ? input_constants(model.input) : "{}")
           << ",\n    .features = " << (features ? feature_constants(model) : "{}")
           << ",\n    .physics = " << (model.physics ? physics_constants(*model.physics) : "{}")
           << ",\n    .output_offset = " << braced(model.outputs.offset)
           << ",\n    .output_noise_std = " << braced(model.outputs.noise_std)
           << ",\n    .position_limit = " << braced(model.limits.position_rad)
           << ",\n    .output_limit = " << braced(model.limits.output)
           << ",\n    .innovation_limit = " << literal(model.limits.innovation)
           << ",\n    .innovation_patience = " << model.limits.innovation_patience
           << prediction_limit(model.limits) << ",\n    .learner = " << learner_constants(model)
           << extrapolation_constants(model) << "};\n\n} // namespace " << name_space << "\n";
    return header.str();
}

} // namespace dfdyn::tools
