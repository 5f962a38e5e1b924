// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/text.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/file/model_json.hpp"
#include "tools/model/inputs/input_description.hpp"

#include <array>
#include <charconv>

namespace dfdyn::tools {

namespace {

using nlohmann::ordered_json;

Derivatives read_derivatives(const JsonReader& reader) {
    const std::string text = reader.text("derivatives");
    if (text != "measured" && text != "estimated") {
        throw reader.error("derivatives", "\"measured\" or \"estimated\"", in_quotes(text));
    }
    return text == "measured" ? Derivatives::measured : Derivatives::estimated;
}

} // namespace

/// Returns the double with the shortest decimal text that represents `value` in single precision.
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
    const InputDescription& description = input_description(input.kind);
    ordered_json json{
        {"kind", description.name}, {"lags", input.lags}, {"rows_per_joint", input.rows_per_joint}};
    if (description.uses_derivatives()) {
        json["derivatives"] = input.derivatives == Derivatives::measured ? "measured" : "estimated";
        if (input.derivatives == Derivatives::estimated) {
            json["position_noise_bound"] = single(input.position_noise_bound);
        }
    } else {
        json["rows"] = input.rows;
    }
    if (description.filters) {
        json["alpha"] = input.alpha;
        json["beta"] = input.beta;
    }
    json["scale"] = singles(input.scale);
    return json;
}

InputModel read_input(const JsonReader& reader, int joints) {
    InputModel input;
    input.kind = parse_input_kind(reader.text("kind"));
    const InputDescription& description = input_description(input.kind);
    input.lags = reader.whole_number("lags", 0, largest_lag_count);
    input.rows_per_joint = reader.whole_number("rows_per_joint", 1, largest_lag_count + 1);
    if (description.uses_derivatives()) {
        input.derivatives = read_derivatives(reader);
    }
    if (!description.fits(input)) {
        throw reader.error("rows_per_joint",
                           "a number that fits input " + std::string(description.name) + " with " +
                               std::to_string(input.lags) + " lags",
                           std::to_string(input.rows_per_joint));
    }
    if (!description.uses_derivatives()) {
        input.rows = reader.numbers("rows", input.rows_per_joint * (input.lags + 1));
    } else if (input.derivatives == Derivatives::estimated) {
        input.position_noise_bound = reader.positive_number("position_noise_bound");
    }
    if (description.filters) {
        const auto alpha = reader.numbers("alpha", 2);
        const auto beta = reader.numbers("beta", 2);
        input.alpha = {alpha[0], alpha[1]};
        input.beta = {beta[0], beta[1]};
    }
    input.scale = reader.numbers("scale", joints * input.rows_per_joint);
    return input;
}

ordered_json start_to_json(const StartModel& start) {
    return {{"weights", singles(start.weights)},
            {"unit_upper", singles(start.unit_upper)},
            {"diagonal", singles(start.diagonal)}};
}

StartModel read_start(const JsonReader& reader, int columns, int outputs) {
    return {reader.numbers("weights", outputs * columns),
            reader.numbers("unit_upper", columns * (columns - 1) / 2),
            reader.positive_numbers("diagonal", columns)};
}

} // namespace dfdyn::tools
