// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/run/job_result.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>

namespace dfdyn::tools {

namespace {

using nlohmann::ordered_json;

/// Returns `value` rounded to six significant digits.
double rounded(double value) {
    std::array<char, 32> text{};
    const auto end =
        std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6).ptr;
    double result = 0;
    std::from_chars(text.data(), end, result);
    return result;
}

ordered_json number_to_json(double value) {
    if (std::isfinite(value)) {
        return rounded(value);
    }
    return std::isnan(value) ? ordered_json() : ordered_json("inf");
}

double number_from_json(const ordered_json& json) {
    if (json.is_null()) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    return json == "inf" ? std::numeric_limits<double>::infinity() : json.get<double>();
}

ordered_json numbers_to_json(const std::vector<double>& values) {
    ordered_json json = ordered_json::array();
    for (const double value : values) {
        json.push_back(number_to_json(value));
    }
    return json;
}

std::vector<double> numbers_from_json(const ordered_json& json) {
    std::vector<double> values;
    for (const ordered_json& value : json) {
        values.push_back(number_from_json(value));
    }
    return values;
}

} // namespace

ordered_json job_to_json(const JobResult& result) {
    ordered_json error = ordered_json::array();
    for (const auto& group : result.error) {
        ordered_json& subsets = error.emplace_back(ordered_json::array());
        for (const auto& subset : group) {
            subsets.push_back(numbers_to_json(subset));
        }
    }
    return {{"case", result.case_name},
            {"seed", result.seed},
            {"sample_period_s", result.sample_period_s},
            {"nrmse", numbers_to_json(result.normalised_error)},
            {"median_us", number_to_json(result.median_us)},
            {"operations", result.operations},
            {"state_bytes", result.state_bytes},
            {"columns", result.columns},
            {"error", std::move(error)}};
}

JobResult unit_from_json(const ordered_json& json) {
    JobResult result;
    json.at("case").get_to(result.case_name);
    json.at("seed").get_to(result.seed);
    json.at("sample_period_s").get_to(result.sample_period_s);
    result.normalised_error = numbers_from_json(json.at("nrmse"));
    result.median_us = number_from_json(json.at("median_us"));
    json.at("operations").get_to(result.operations);
    json.at("state_bytes").get_to(result.state_bytes);
    json.at("columns").get_to(result.columns);
    for (const ordered_json& group : json.at("error")) {
        auto& subsets = result.error.emplace_back();
        for (const ordered_json& subset : group) {
            subsets.push_back(numbers_from_json(subset));
        }
    }
    return result;
}

} // namespace dfdyn::tools
