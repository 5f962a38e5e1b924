// SPDX-License-Identifier: Apache-2.0
#include "tools/model/model_file.hpp"

#include "dfdyn/snapshot.hpp"
#include "tools/common/error.hpp"
#include "tools/common/text.hpp"
#include "tools/model/json_reader.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <iterator>
#include <span>
#include <utility>

namespace dfdyn::tools {

namespace {

using nlohmann::ordered_json;

constexpr const char* schema = "dfdyn.model/1";

constexpr std::array<std::pair<InputKind, const char*>, 5> input_names{{{InputKind::STD, "STD"},
                                                                        {InputKind::DF, "DF"},
                                                                        {InputKind::DFW, "DFW"},
                                                                        {InputKind::DFR, "DFR"},
                                                                        {InputKind::DFSR, "DFSR"}}};

/// Sizes that no arm exceeds: a hostile file must not make the program ask for terabytes.
constexpr int largest_joint_count = 64;
constexpr int largest_lag_count = 1000;
constexpr int largest_feature_count = 5000;
constexpr int largest_output_count = 64;

/// The double whose shortest decimal text is that of `value` in single precision.
double single(double value) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), static_cast<float>(value)).ptr;
    double result = 0;
    std::from_chars(text.data(), end, result);
    return result;
}

ordered_json singles(std::span<const double> values) {
    ordered_json array = ordered_json::array();
    for (const double value : values) {
        array.push_back(single(value));
    }
    return array;
}

ordered_json input_to_json(const InputModel& input) {
    ordered_json json{
        {"kind", to_string(input.kind)}, {"lags", input.lags}, {"rows_per_joint", input.rows_per_joint}};
    if (input.kind == InputKind::STD) {
        json["position_noise_bound"] = single(input.position_noise_bound);
    } else {
        json["rows"] = input.rows;
    }
    if (input.kind == InputKind::DFSR) {
        json["alpha"] = input.alpha;
        json["beta"] = input.beta;
    }
    json["scale"] = singles(input.scale);
    return json;
}

ordered_json model_json(const TrainedModel& model) {
    return {{"schema", schema},
            {"structure", model.structure},
            {"joints", model.joints},
            {"sample_period_s", model.sample_period_s},
            {"forgetting_factor", single(model.forgetting_factor)},
            {"input", input_to_json(model.input)},
            {"features",
             {{"orthogonal", model.features.orthogonal},
              {"count", model.features.count},
              {"seed", model.features.seed},
              {"length_scale", model.features.length_scale},
              {"omega", singles(model.features.omega)}}},
            {"outputs",
             {{"names", model.outputs.names},
              {"offset", singles(model.outputs.offset)},
              {"noise_std", singles(model.outputs.noise_std)},
              {"prior_variance", single(model.outputs.prior_variance)}}},
            {"limits",
             {{"position_rad", singles(model.limits.position_rad)},
              {"output", singles(model.limits.output)},
              {"innovation", single(model.limits.innovation)},
              {"innovation_patience", model.limits.innovation_patience}}},
            {"start",
             {{"weights", singles(model.start.weights)},
              {"unit_upper", singles(model.start.unit_upper)},
              {"diagonal", singles(model.start.diagonal)}}},
            {"training",
             {{"recordings", model.training.recordings},
              {"rows", model.training.rows},
              {"method", model.training.method},
              {"seed", model.training.seed},
              {"likelihood_rows", model.training.likelihood_rows},
              {"log_likelihood", model.training.log_likelihood},
              {"all_starts", model.training.all_starts}}}};
}

InputModel read_input(const JsonReader& reader, int joints) {
    InputModel input;
    input.kind = parse_input_kind(reader.text("kind"));
    input.lags = reader.whole_number("lags", 0, largest_lag_count);
    input.rows_per_joint = reader.whole_number("rows_per_joint", 1, largest_lag_count + 1);
    const bool full = input.kind == InputKind::DF || input.kind == InputKind::DFW;
    const bool three = input.kind == InputKind::STD || input.kind == InputKind::DFSR;
    if ((full && input.rows_per_joint != input.lags + 1) ||
        (three && (input.rows_per_joint != 3 || input.lags < 2)) || input.rows_per_joint > input.lags + 1) {
        throw reader.error("rows_per_joint",
                           "a number that fits input " + to_string(input.kind) + " with " +
                               std::to_string(input.lags) + " lags",
                           std::to_string(input.rows_per_joint));
    }
    if (input.kind == InputKind::STD) {
        input.position_noise_bound = reader.positive_number("position_noise_bound");
    } else {
        input.rows = reader.numbers("rows", input.rows_per_joint * (input.lags + 1));
    }
    if (input.kind == InputKind::DFSR) {
        const auto alpha = reader.numbers("alpha", 2);
        const auto beta = reader.numbers("beta", 2);
        input.alpha = {alpha[0], alpha[1]};
        input.beta = {beta[0], beta[1]};
    }
    input.scale = reader.numbers("scale", joints * input.rows_per_joint);
    return input;
}

FeatureModel read_features(const JsonReader& reader, int inputs) {
    FeatureModel features;
    features.orthogonal = reader.flag("orthogonal");
    features.count = reader.whole_number("count", 1, largest_feature_count);
    features.seed = reader.seed("seed");
    features.length_scale = reader.positive_number("length_scale");
    features.omega = reader.numbers("omega", features.count * inputs);
    return features;
}

OutputModel read_outputs(const JsonReader& reader) {
    OutputModel outputs;
    outputs.names = reader.texts("names", largest_output_count);
    const int count = static_cast<int>(outputs.names.size());
    outputs.offset = reader.numbers("offset", count);
    outputs.noise_std = reader.positive_numbers("noise_std", count);
    outputs.prior_variance = reader.positive_number("prior_variance");
    return outputs;
}

StartModel read_start(const JsonReader& reader, int columns, int outputs) {
    return {reader.numbers("weights", outputs * columns),
            reader.numbers("unit_upper", columns * (columns - 1) / 2),
            reader.positive_numbers("diagonal", columns)};
}

TrainingRecord read_training(const JsonReader& reader) {
    TrainingRecord record;
    record.recordings = reader.texts("recordings", 10000);
    record.rows = reader.text("rows");
    record.method = reader.text("method");
    record.seed = reader.seed("seed");
    record.likelihood_rows = reader.whole_number("likelihood_rows", 0, 1000000000);
    record.log_likelihood = reader.number("log_likelihood");
    record.all_starts = reader.numbers("all_starts");
    return record;
}

TrainedModel read_fields(const JsonReader& reader) {
    const std::string found = reader.text("schema");
    if (found != schema) {
        throw reader.error("schema", in_quotes(schema), in_quotes(found));
    }
    TrainedModel model;
    model.structure = reader.text("structure");
    if (model.structure != "NP") {
        throw reader.error("structure", "\"NP\"", in_quotes(model.structure));
    }
    model.joints = reader.whole_number("joints", 1, largest_joint_count);
    model.sample_period_s = reader.number_within("sample_period_s", 1e-6, 10);
    model.input = read_input(reader.object("input"), model.joints);
    model.features = read_features(reader.object("features"), model.joints * model.input.rows_per_joint);
    model.forgetting_factor =
        reader.number_within("forgetting_factor", least_forgetting_factor(model.features.count), 1);
    model.outputs = read_outputs(reader.object("outputs"));
    const int outputs = static_cast<int>(model.outputs.names.size());
    const JsonReader limits = reader.object("limits");
    model.limits = {limits.positive_numbers("position_rad", model.joints),
                    limits.positive_numbers("output", outputs), limits.positive_number("innovation"),
                    limits.whole_number("innovation_patience", 0, 1000000)};
    model.start = read_start(reader.object("start"), 2 * model.features.count, outputs);
    model.training = read_training(reader.object("training"));
    return model;
}

} // namespace

double least_forgetting_factor(int feature_count) { return 1 - 1 / (2.0 * feature_count); }

std::string to_string(InputKind kind) {
    for (const auto& [known, name] : input_names) {
        if (known == kind) {
            return name;
        }
    }
    throw std::logic_error("an input kind without a name");
}

InputKind parse_input_kind(const std::string& name) {
    for (const auto& [kind, known] : input_names) {
        if (known == name) {
            return kind;
        }
    }
    throw InputError("input: expected STD, DF, DFW, DFR or DFSR, found " + in_quotes(name));
}

std::string model_to_json(const TrainedModel& model) { return model_json(model).dump() + "\n"; }

TrainedModel model_from_json(const std::string& text, const std::string& source) {
    const nlohmann::json json = parse_json(text, source);
    return read_fields(JsonReader(json, source));
}

TrainedModel read_model(const std::filesystem::path& path) {
    if (std::filesystem::is_directory(path)) {
        throw system_error(path, "cannot be read as a model", EISDIR);
    }
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (!file || text.empty()) {
        throw system_error(path, "cannot be read as a model", errno != 0 ? errno : ENODATA);
    }
    return model_from_json(text, shown(path));
}

std::uint32_t model_identity(const TrainedModel& model) {
    const std::string text = model_to_json(model);
    return crc32(std::as_bytes(std::span(text)));
}

} // namespace dfdyn::tools
