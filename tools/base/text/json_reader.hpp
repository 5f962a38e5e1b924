// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/error.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Parses the JSON in `text`. Throws InputError with source and position in one line.
nlohmann::json parse_json(const std::string& text, const std::string& source);

/// Reads the fields of one JSON object. Every method throws InputError `SOURCE: path.to.field: expected …,
/// found …` if the field is missing, has another type or size, or is out of range. All numbers must be
/// finite, also in single precision. Refers to `json`.
class JsonReader {
  public:
    JsonReader(const nlohmann::json& json, std::string source);

    bool has(const std::string& name) const { return json_->contains(name); }

    /// Rejects all fields that are not in `names`.
    void allow_only(std::span<const std::string_view> names) const;

    JsonReader object(const std::string& name) const;

    std::vector<JsonReader> objects(const std::string& name, int at_least, int at_most) const;

    std::string text(const std::string& name) const;
    std::vector<std::string> texts(const std::string& name, int at_most) const;
    bool is_array(const std::string& name) const { return field(name).is_array(); }
    bool flag(const std::string& name) const;
    int whole_number(const std::string& name, int low, int high) const;
    std::vector<int> whole_numbers(const std::string& name, int low, int high) const;
    std::uint64_t seed(const std::string& name) const;
    double number(const std::string& name) const;
    double positive_number(const std::string& name) const;
    double number_within(const std::string& name, double low, double high) const;
    /// Returns `absent` if the field is missing.
    int whole_or(const std::string& name, int absent, int low, int high) const {
        return has(name) ? whole_number(name, low, high) : absent;
    }
    double number_or(const std::string& name, double absent, double low, double high) const {
        return has(name) ? number_within(name, low, high) : absent;
    }
    std::vector<double> numbers(const std::string& name) const;
    std::vector<double> numbers(const std::string& name, int count) const;
    std::vector<double> positive_numbers(const std::string& name, int count) const;

    InputError error(const std::string& name, const std::string& expected, const std::string& found) const;

  private:
    JsonReader(const nlohmann::json& json, std::string source, std::string path);

    const nlohmann::json& field(const std::string& name) const;
    const nlohmann::json& array(const std::string& name) const;
    int checked_whole(const nlohmann::json& value, const std::string& name, int low, int high) const;
    double checked(const nlohmann::json& value, const std::string& name) const;

    const nlohmann::json* json_;
    std::string source_;
    std::string path_; ///< "" or "input."
};

} // namespace dfdyn::tools
