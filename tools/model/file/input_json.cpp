// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/text.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/file/model_json.hpp"

#include <array>
#include <charconv>
#include <utility>

namespace dfdyn::tools {

namespace {

using nlohmann::ordered_json;

constexpr std::array<std::pair<InputKind, const char*>, 5> input_names{{{InputKind::STD, "STD"},
                                                                        {InputKind::DF, "DF"},
                                                                        {InputKind::DFW, "DFW"},
                                                                        {InputKind::DFR, "DFR"},
                                                                        {InputKind::DFSR, "DFSR"}}};

Derivatives read_derivatives(const JsonReader& reader) {
    const std::string text = reader.text("derivatives");
    if (text != "measured" && text != "estimated") {
        throw reader.error("derivatives", "\"measured\" or \"estimated\"", in_quotes(text));
    }
    return text == "measured" ? Derivatives::measured : Derivatives::estimated;
}

/// Returns whether an input of its kind can have this number of lags and rows per joint.
bool fits(const InputModel& input) {
    const int rows = input.rows_per_joint;
    switch (input.kind) {
    case InputKind::STD:
        return rows == 3 && (input.derivatives == Derivatives::measured ? input.lags == 0 : input.lags >= 2);
    case InputKind::DF:
    case InputKind::DFW:
        return rows == input.lags + 1;
    case InputKind::DFSR:
        return rows == 3 && input.lags >= 2;
    default:
        return rows <= input.lags + 1;
    }
}

} // namespace

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
    ordered_json json{
        {"kind", to_string(input.kind)}, {"lags", input.lags}, {"rows_per_joint", input.rows_per_joint}};
    if (input.kind == InputKind::STD) {
        json["derivatives"] = input.derivatives == Derivatives::measured ? "measured" : "estimated";
        if (input.derivatives == Derivatives::estimated) {
            json["position_noise_bound"] = single(input.position_noise_bound);
        }
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

InputModel read_input(const JsonReader& reader, int joints) {
    InputModel input;
    input.kind = parse_input_kind(reader.text("kind"));
    input.lags = reader.whole_number("lags", 0, largest_lag_count);
    input.rows_per_joint = reader.whole_number("rows_per_joint", 1, largest_lag_count + 1);
    if (input.kind == InputKind::STD) {
        input.derivatives = read_derivatives(reader);
    }
    if (!fits(input)) {
        throw reader.error("rows_per_joint",
                           "a number that fits input " + to_string(input.kind) + " with " +
                               std::to_string(input.lags) + " lags",
                           std::to_string(input.rows_per_joint));
    }
    if (input.kind != InputKind::STD) {
        input.rows = reader.numbers("rows", input.rows_per_joint * (input.lags + 1));
    } else if (input.derivatives == Derivatives::estimated) {
        input.position_noise_bound = reader.positive_number("position_noise_bound");
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
