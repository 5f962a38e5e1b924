// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/json_reader.hpp"

#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace dfdyn::tools {

namespace {

std::string shown_value(const nlohmann::json& value) {
    if (value.is_structured()) {
        return value.is_array() ? "an array" : "an object";
    }
    if (value.is_string()) {
        return in_quotes(value.get<std::string>());
    }
    return in_quotes(value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace));
}

} // namespace

nlohmann::json parse_json(const std::string& text, const std::string& source) {
    try {
        return nlohmann::json::parse(text);
    } catch (const nlohmann::json::parse_error& failure) {
        throw InputError(source + ": byte " + std::to_string(failure.byte) +
                         ": expected JSON, found something else or the end of the file");
    } catch (const nlohmann::json::out_of_range&) {
        throw InputError(source + ": expected numbers that a double holds, found a larger one");
    }
}

JsonReader::JsonReader(const nlohmann::json& json, std::string source)
    : JsonReader(json, std::move(source), "") {
    if (!json.is_object()) {
        throw InputError(source_ + ": expected a JSON object, found " + shown_value(json));
    }
}

JsonReader::JsonReader(const nlohmann::json& json, std::string source, std::string path)
    : json_(&json), source_(std::move(source)), path_(std::move(path)) {}

InputError JsonReader::error(const std::string& name, const std::string& expected,
                             const std::string& found) const {
    return InputError(source_ + ": " + path_ + name + ": expected " + expected + ", found " + found);
}

const nlohmann::json& JsonReader::field(const std::string& name) const {
    const auto found = json_->find(name);
    if (found == json_->end()) {
        throw error(name, "this field", "none");
    }
    return *found;
}

std::vector<JsonReader> JsonReader::objects(const std::string& name, int at_least, int at_most) const {
    const nlohmann::json& values = array(name);
    const auto count = static_cast<int>(values.size());
    if (count < at_least || count > at_most) {
        throw error(name, std::to_string(at_least) + " to " + std::to_string(at_most) + " objects",
                    std::to_string(count));
    }
    std::vector<JsonReader> result;
    for (const nlohmann::json& value : values) {
        if (!value.is_object()) {
            throw error(name + "[" + std::to_string(result.size()) + "]", "an object", shown_value(value));
        }
        result.push_back({value, source_, path_ + name + "[" + std::to_string(result.size()) + "]."});
    }
    return result;
}

void JsonReader::allow_only(std::span<const std::string_view> names) const {
    for (const auto& [name, value] : json_->items()) {
        if (std::ranges::find(names, name) == names.end()) {
            std::string known;
            for (const std::string_view one : names) {
                known.append(known.empty() ? "" : ", ").append(one);
            }
            throw InputError(source_ + ": " + path_ + "field " + in_quotes(name) + ": expected one of " +
                             known + ", found another" +
                             suggestion(name, std::vector<std::string>(names.begin(), names.end())));
        }
    }
}

JsonReader JsonReader::object(const std::string& name) const {
    const nlohmann::json& value = field(name);
    if (!value.is_object()) {
        throw error(name, "an object", shown_value(value));
    }
    return {value, source_, path_ + name + "."};
}

std::string JsonReader::text(const std::string& name) const {
    const nlohmann::json& value = field(name);
    if (!value.is_string()) {
        throw error(name, "a text", shown_value(value));
    }
    return value.get<std::string>();
}

const nlohmann::json& JsonReader::array(const std::string& name) const {
    const nlohmann::json& value = field(name);
    if (!value.is_array()) {
        throw error(name, "an array", shown_value(value));
    }
    return value;
}

std::vector<std::string> JsonReader::texts(const std::string& name, int at_most) const {
    const nlohmann::json& values = array(name);
    if (values.empty() || values.size() > static_cast<std::size_t>(at_most)) {
        throw error(name, "1 to " + std::to_string(at_most) + " texts", std::to_string(values.size()));
    }
    std::vector<std::string> result;
    for (const nlohmann::json& value : values) {
        if (!value.is_string()) {
            throw error(name, "texts", shown_value(value));
        }
        result.push_back(value.get<std::string>());
    }
    return result;
}

bool JsonReader::flag(const std::string& name) const {
    const nlohmann::json& value = field(name);
    if (!value.is_boolean()) {
        throw error(name, "true or false", shown_value(value));
    }
    return value.get<bool>();
}

int JsonReader::checked_whole(const nlohmann::json& value, const std::string& name, int low, int high) const {
    const bool small = value.is_number_integer() &&
                       (!value.is_number_unsigned() || value.get<std::uint64_t>() < (1ULL << 62U));
    if (!small || value.get<std::int64_t>() < low || value.get<std::int64_t>() > high) {
        throw error(name, "a whole number from " + std::to_string(low) + " to " + std::to_string(high),
                    shown_value(value));
    }
    return value.get<int>();
}

int JsonReader::whole_number(const std::string& name, int low, int high) const {
    return checked_whole(field(name), name, low, high);
}

std::vector<int> JsonReader::whole_numbers(const std::string& name, int low, int high) const {
    std::vector<int> result;
    for (const nlohmann::json& value : array(name)) {
        result.push_back(checked_whole(value, name, low, high));
    }
    return result;
}

std::uint64_t JsonReader::seed(const std::string& name) const {
    const nlohmann::json& value = field(name);
    if (!value.is_number_unsigned()) {
        throw error(name, "a whole number that is not negative", shown_value(value));
    }
    return value.get<std::uint64_t>();
}

double JsonReader::checked(const nlohmann::json& value, const std::string& name) const {
    if (!value.is_number() ||
        !(std::abs(value.get<double>()) <= static_cast<double>(std::numeric_limits<float>::max()))) {
        throw error(name, "a number that single precision holds", shown_value(value));
    }
    return value.get<double>();
}

double JsonReader::number(const std::string& name) const { return checked(field(name), name); }

double JsonReader::positive_number(const std::string& name) const {
    const double value = number(name);
    if (!(static_cast<float>(value) > 0)) {
        throw error(name, "a positive number", number_text(value));
    }
    return value;
}

double JsonReader::number_within(const std::string& name, double low, double high) const {
    const double value = number(name);
    if (!(value >= low && value <= high)) {
        throw error(name, "a number from " + number_text(low) + " to " + number_text(high),
                    number_text(value));
    }
    return value;
}

std::vector<double> JsonReader::numbers(const std::string& name) const {
    std::vector<double> result;
    for (const nlohmann::json& value : array(name)) {
        result.push_back(checked(value, name));
    }
    return result;
}

std::vector<double> JsonReader::numbers(const std::string& name, int count) const {
    const nlohmann::json& values = array(name);
    if (values.size() != static_cast<std::size_t>(count)) {
        throw error(name, std::to_string(count) + " numbers", std::to_string(values.size()));
    }
    return numbers(name);
}

std::vector<double> JsonReader::positive_numbers(const std::string& name, int count) const {
    std::vector<double> result = numbers(name, count);
    for (const double value : result) {
        if (!(static_cast<float>(value) > 0)) {
            throw error(name, "positive numbers", number_text(value));
        }
    }
    return result;
}

} // namespace dfdyn::tools
