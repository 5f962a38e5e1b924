// SPDX-License-Identifier: Apache-2.0
#include "tools/model/model_header.hpp"

#include "tools/host/host_model.hpp"
#include "tools/model/model_file.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <span>
#include <sstream>
#include <string_view>

namespace dfdyn::tools {

namespace {

/// A float literal that compiles to exactly `value` in single precision.
std::string literal(double value) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), static_cast<float>(value)).ptr;
    std::string result(text.data(), end);
    if (result.find_first_of(".e") == std::string::npos) {
        result += ".0";
    }
    return result + "F";
}

/// `{{1.0F, 2.0F}}`, wrapped.
std::string braced(std::span<const double> values) {
    constexpr std::size_t width = 100;
    std::string result = "{{";
    std::size_t line = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::string item = literal(values[i]) + (i + 1 < values.size() ? "," : "");
        if (line + item.size() > width) {
            result += "\n    ";
            line = 0;
        } else if (line > 0) {
            result += ' ';
        }
        result += item;
        line += item.size() + 1;
    }
    return result + "}}";
}

std::string input_type(const InputModel& input) {
    const std::string lags = std::to_string(input.lags);
    switch (input.kind) {
    case InputKind::STD:
        return "Standard<" + lags + ">";
    case InputKind::DF:
        return "DerivativeFree<" + lags + ">";
    case InputKind::DFW:
        return "DerivativeFreeWeighted<" + lags + ">";
    case InputKind::DFR:
        return "DerivativeFreeReduced<" + lags + ", " + std::to_string(input.rows_per_joint) + ">";
    case InputKind::DFSR:
        return "DerivativeFreeStructured<" + lags + ">";
    }
    throw std::logic_error("an input kind without a type");
}

std::string input_constants(const InputModel& input) {
    std::string fields;
    if (input.kind == InputKind::STD) {
        fields += ".position_noise_bound = " + literal(input.position_noise_bound) + ",\n        ";
    }
    if (input.kind == InputKind::DFR || input.kind == InputKind::DFSR) {
        fields += ".rows = " + braced(firmware_rows(input)) + ",\n        ";
    }
    return "{" + fields + ".scale = " + braced(firmware_scale(input)) + "}";
}

std::string joined(std::span<const std::string> texts) {
    std::string result;
    for (const std::string& text : texts) {
        result += (result.empty() ? "" : " ") + text;
    }
    return result;
}

/// Text for a comment: whatever a file may be called, it stays one line of printable characters.
std::string comment(std::string_view text) {
    std::string result;
    for (const char c : text) {
        result += std::isprint(static_cast<unsigned char>(c)) != 0 && c != '\\' ? c : '?';
    }
    return result;
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
    const std::string outputs = std::to_string(model.outputs.names.size());
    const std::string columns = std::to_string(2 * model.features.count);
    std::ostringstream header;
    header << "// Written by `dfdyn train`; do not edit. Outputs: " << comment(joined(model.outputs.names))
           << ".\n"
           << "// Trained on " << comment(joined(model.training.recordings)) << ", rows "
           << comment(model.training.rows) << ", sampled every " << model.sample_period_s << " s.\n"
           << "// clang-format off\n#pragma once\n\n#include \"dfdyn/dfdyn.hpp\"\n\nnamespace " << name_space
           << " {\n\n"
           << "using Model = dfdyn::Model<float, dfdyn::Joints<" << model.joints << ", " << outputs
           << ">, dfdyn::" << input_type(model.input) << ", dfdyn::RandomFourier<" << model.features.count
           << ">>;\n\n"
           << "inline constexpr dfdyn::LearnerStart<float, " << columns << ", " << outputs
           << "> start{\n    .weights = " << braced(model.start.weights)
           << ",\n    .unit_upper = " << braced(model.start.unit_upper)
           << ",\n    .diagonal = " << braced(model.start.diagonal) << "};\n\n"
           << "inline constexpr Model::Constants constants{\n    .sizes = {},\n    .identity = "
           << model_identity(model) << "U,\n    .gap_ns = " << gap_ns(model)
           << ",\n    .input = " << input_constants(model.input) << ",\n    .features = {.frequencies = "
           << braced(firmware_frequencies(model.features, model.joints * model.input.rows_per_joint))
           << ",\n        .amplitude = " << literal(1 / std::sqrt(static_cast<double>(model.features.count)))
           << "},\n    .physics = {},\n    .output_offset = " << braced(model.outputs.offset)
           << ",\n    .output_noise_std = " << braced(model.outputs.noise_std)
           << ",\n    .position_limit = " << braced(model.limits.position_rad)
           << ",\n    .output_limit = " << braced(model.limits.output)
           << ",\n    .innovation_limit = " << literal(model.limits.innovation)
           << ",\n    .innovation_patience = " << model.limits.innovation_patience
           << ",\n    .learner = {.prior_variance = " << literal(model.outputs.prior_variance)
           << ", .forgetting_factor = " << literal(model.forgetting_factor)
           << ", .start = &start}};\n\n} // namespace " << name_space << "\n";
    return header.str();
}

} // namespace dfdyn::tools
