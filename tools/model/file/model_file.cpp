// SPDX-License-Identifier: Apache-2.0
#include "tools/model/file/model_file.hpp"

#include "dfdyn/core/snapshot.hpp"
#include "dfdyn/monitor/contact_detector.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/base/system/read_file.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/json_reader.hpp"
#include "tools/base/text/json_text.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/model/file/model_json.hpp"
#include "tools/model/structure.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <charconv>
#include <span>
#include <utility>

namespace dfdyn::tools {

namespace {

using nlohmann::ordered_json;

constexpr const char* schema = "dfdyn.model/1";

/// Upper limits of sizes, above those of any arm: a malicious file must not cause excessive allocations.
constexpr int largest_joint_count = static_cast<int>(largest_recorded_joint_count);
constexpr int largest_feature_count = 5000;
constexpr int largest_output_count = 64;
constexpr double largest_parameter_variance_factor = 1e9;
constexpr double largest_rate_slope = 1;

ordered_json features_to_json(const FeatureModel& features) {
    return {{"orthogonal", features.orthogonal},
            {"count", features.count},
            {"seed", features.seed},
            {"length_scale", features.length_scale},
            {"omega", singles(features.omega)}};
}

ordered_json contact_to_json(const ContactModel& contact) {
    ordered_json json{{"limit", singles(contact.limit)}, {"usual", singles(contact.usual)}};
    if (contact.rate_slope > 0) { // absent from older files
        json["relative"] = singles(contact.relative);
        json["speed"] = singles(contact.speed);
        json["acceleration"] = singles(contact.acceleration);
        json["rate_slope"] = single(contact.rate_slope);
    }
    if (!contact.standard_deviation.empty()) { // absent from older files
        json["standard_deviation"] = singles(contact.standard_deviation);
    }
    if (!contact.hysteresis.empty()) { // absent from older files
        json["hysteresis"] = singles(contact.hysteresis);
    }
    return json;
}

ordered_json extrapolation_to_json(const ExtrapolationModel& extrapolation, const Structure& structure) {
    ordered_json json{{"extra_noise", singles(extrapolation.extra_noise)}};
    if (structure.features) {
        json["inverse_far_variance"] = single(extrapolation.inverse_far_variance);
        json["prior_variance"] = singles(extrapolation.prior_variance);
    }
    if (!extrapolation.output_variance.empty()) {
        json["parameter_variance_factor"] = single(extrapolation.parameter_variance_factor);
        json["output_variance"] = singles(extrapolation.output_variance);
    }
    return json;
}

ordered_json training_to_json(const TrainingRecord& record) {
    ordered_json json{{"recordings", record.recordings},
                      {"rows", record.rows},
                      {"method", record.method},
                      {"seed", record.seed},
                      {"likelihood_rows", record.likelihood_rows},
                      {"log_likelihood", record.log_likelihood},
                      {"all_starts", record.all_starts}};
    if (!record.columns.empty()) {
        json["columns"] = record.columns;
    }
    if (!record.units.empty()) {
        json["units"] = record.units;
    }
    if (!record.joint_names.empty()) {
        json["joint_names"] = record.joint_names;
    }
    for (const SizeRecord& size : record.sizes) {
        json["sizes"].push_back({{"features", size.features},
                                 {"flash_bytes", size.flash_bytes},
                                 {"ram_bytes", size.ram_bytes},
                                 {"tick_operations", size.tick_operations},
                                 {"held_out_nrmse", size.error}});
    }
    return json;
}

ordered_json model_json(const TrainedModel& model) {
    ordered_json json{{"schema", schema},
                      {"structure", model.structure},
                      {"joints", model.joints},
                      {"sample_period_s", model.sample_period_s},
                      {"forgetting_factor", single(model.forgetting_factor)}};
    if (structure_of(model).features) {
        json["input"] = input_to_json(model.input);
        json["features"] = features_to_json(model.features);
    }
    if (model.physics) {
        json["physics"] = physics_to_json(*model.physics);
    }
    json["outputs"] = {{"names", model.outputs.names},
                       {"offset", singles(model.outputs.offset)},
                       {"noise_std", singles(model.outputs.noise_std)},
                       {"prior_variance", single(model.outputs.prior_variance)}};
    json["limits"] = {{"position_rad", singles(model.limits.position_rad)},
                      {"output", singles(model.limits.output)},
                      {"innovation", single(model.limits.innovation)},
                      {"innovation_patience", model.limits.innovation_patience}};
    if (!model.limits.prediction.empty()) { // absent from older files, which keep their identity
        json["limits"]["prediction"] = singles(model.limits.prediction);
    }
    if (!model.contact.limit.empty()) {
        json["contact"] = contact_to_json(model.contact);
    }
    if (model.extrapolation) {
        json["extrapolation"] = extrapolation_to_json(*model.extrapolation, structure_of(model));
    }
    if (structure_of(model).features) {
        json["start"] = start_to_json(model.start);
    }
    json["training"] = training_to_json(model.training);
    return json;
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

ExtrapolationModel read_extrapolation(const JsonReader& reader, int outputs, const Structure& structure) {
    ExtrapolationModel extrapolation;
    if (structure.features) {
        extrapolation.inverse_far_variance = reader.positive_number("inverse_far_variance");
    }
    extrapolation.extra_noise = reader.numbers("extra_noise", outputs);
    for (const double value : extrapolation.extra_noise) {
        if (value < 0) {
            throw reader.error("extra_noise", "numbers of at least 0", in_quotes(number_text(value)));
        }
    }
    extrapolation.prior_variance.assign(static_cast<std::size_t>(outputs), 0);
    if (structure.features) {
        extrapolation.prior_variance = reader.positive_numbers("prior_variance", outputs);
    }
    if (structure.learns_parameters() && reader.has("parameter_variance_factor")) {
        extrapolation.parameter_variance_factor =
            reader.number_within("parameter_variance_factor", 1, largest_parameter_variance_factor);
        extrapolation.output_variance = reader.positive_numbers("output_variance", outputs);
    }
    return extrapolation;
}

void check_not_negative(const JsonReader& reader, const char* name, const std::vector<double>& values) {
    for (const double value : values) {
        if (value < 0) {
            throw reader.error(name, "numbers of at least 0", in_quotes(number_text(value)));
        }
    }
}

ContactModel read_contact(const JsonReader& reader, int outputs) {
    ContactModel contact;
    contact.limit = reader.positive_numbers("limit", joint_motion_count * outputs);
    contact.usual = reader.numbers("usual", joint_motion_count * outputs);
    check_not_negative(reader, "usual", contact.usual);
    if (reader.has("rate_slope")) { // absent from older files
        contact.relative = reader.numbers("relative", outputs);
        check_not_negative(reader, "relative", contact.relative);
        contact.speed = reader.positive_numbers("speed", outputs);
        contact.acceleration = reader.positive_numbers("acceleration", outputs);
        contact.rate_slope = reader.number_within("rate_slope", 0, largest_rate_slope);
    }
    if (reader.has("standard_deviation")) { // absent from older files
        contact.standard_deviation = reader.positive_numbers("standard_deviation", outputs);
    }
    if (reader.has("hysteresis")) { // absent from older files
        contact.hysteresis = reader.numbers("hysteresis", outputs);
        check_not_negative(reader, "hysteresis", contact.hysteresis);
    }
    return contact;
}

LimitModel read_limits(const JsonReader& reader, int joints, int outputs) {
    LimitModel limits;
    limits.position_rad = reader.positive_numbers("position_rad", joints);
    limits.output = reader.positive_numbers("output", outputs);
    limits.innovation = reader.positive_number("innovation");
    limits.innovation_patience = reader.whole_number("innovation_patience", 0, 1000000);
    if (reader.has("prediction")) {
        limits.prediction = reader.positive_numbers("prediction", outputs);
    }
    return limits;
}

constexpr int largest_int = std::numeric_limits<int>::max();

TrainingRecord read_training(const JsonReader& reader) {
    TrainingRecord record;
    record.recordings = reader.texts("recordings", 10000);
    record.rows = reader.text("rows");
    record.method = reader.text("method");
    record.seed = reader.seed("seed");
    record.likelihood_rows = reader.whole_number("likelihood_rows", 0, 1000000000);
    record.log_likelihood = reader.number("log_likelihood");
    record.all_starts = reader.numbers("all_starts");
    record.columns = reader.has("columns") ? reader.text("columns") : "";
    record.units = reader.has("units") ? reader.text("units") : "";
    if (reader.has("joint_names")) {
        record.joint_names = reader.texts("joint_names", 1000);
    }
    if (reader.has("sizes")) {
        for (const JsonReader& size : reader.objects("sizes", 0, 1000)) {
            record.sizes.push_back({size.whole_number("features", 0, 1'000'000),
                                    size.whole_number("flash_bytes", 0, largest_int),
                                    size.whole_number("ram_bytes", 0, largest_int),
                                    size.whole_number("tick_operations", 0, largest_int),
                                    size.number("held_out_nrmse")});
        }
    }
    return record;
}

TrainedModel read_fields(const JsonReader& reader) {
    const std::string found = reader.text("schema");
    if (found != schema) {
        throw reader.error("schema", in_quotes(schema), in_quotes(found));
    }
    TrainedModel model;
    model.structure = reader.text("structure");
    if (find_structure(model.structure) == nullptr) {
        throw reader.error("structure", "one of " + listed(structure_names()), in_quotes(model.structure));
    }
    model.joints = reader.whole_number("joints", 1, largest_joint_count);
    model.sample_period_s = reader.number_within("sample_period_s", 1e-6, 10);
    if (structure_of(model).features) {
        model.input = read_input(reader.object("input"), model.joints);
        model.features = read_features(reader.object("features"), model.joints * model.input.rows_per_joint);
    }
    model.outputs = read_outputs(reader.object("outputs"));
    const int outputs = static_cast<int>(model.outputs.names.size());
    model.limits = read_limits(reader.object("limits"), model.joints, outputs);
    if (reader.has("contact")) {
        model.contact = read_contact(reader.object("contact"), outputs);
    }
    double least = 0;
    if (structure_of(model).features) {
        model.start = read_start(reader.object("start"), 2 * model.features.count, outputs);
        least = least_forgetting_factor(model.features.count);
    }
    if (reader.has("extrapolation")) {
        model.extrapolation =
            read_extrapolation(reader.object("extrapolation"), outputs, structure_of(model));
    }
    if (structure_of(model).has_physics()) {
        model.physics = read_physics(reader.object("physics"), model);
        least = std::max(least, 1 - 1 / static_cast<double>(model.physics->selected.size()));
    }
    model.forgetting_factor = reader.number_within("forgetting_factor", least, 1);
    model.training = read_training(reader.object("training"));
    return model;
}

} // namespace

double least_forgetting_factor(int feature_count) { return 1 - 1 / (2.0 * feature_count); }

std::string model_to_json(const TrainedModel& model) { return json_text(model_json(model), -1) + "\n"; }

TrainedModel model_from_json(const std::string& text, const std::string& source) {
    const nlohmann::json json = parse_json(text, source);
    return read_fields(JsonReader(json, source));
}

TrainedModel read_model(const std::filesystem::path& path) {
    return model_from_json(read_file(path, "cannot be read as a model"), shown(path));
}

std::uint32_t model_identity(const TrainedModel& model) {
    TrainedModel without_contact = model;
    without_contact.contact = {};
    const std::string text = model_to_json(without_contact);
    return crc32(std::as_bytes(std::span(text)));
}

} // namespace dfdyn::tools
