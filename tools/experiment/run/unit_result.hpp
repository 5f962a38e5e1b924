// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// What one case with one draw of random features gave: a unit of an evaluation's work.
struct UnitResult {
    std::string case_name;
    std::uint64_t seed = 0; ///< of the draw
    double sample_period_s = 0;
    /// [group][subset][tick]: the index ε of the T samples after the subset's tick, averaged over the group's
    /// outputs. In a unit's file: NaN where there is none, infinite where an output rests at 0 and is the
    /// scale. Once the units are compared: as `keep_common_ticks` says.
    std::vector<std::vector<std::vector<double>>> error;
    std::vector<double> normalised_error; ///< one-step nRMSE of each output over all subsets
    double median_us = 0;                 ///< of the ticks that learned
    std::int64_t operations = 0;          ///< multiply-adds of a tick that learns
    std::size_t state_bytes = 0;
    int columns = 0; ///< of the learner
};

/// As JSON, the errors with six digits; null for NaN, "inf" for infinite.
nlohmann::ordered_json unit_to_json(const UnitResult& result);

/// Reads what `unit_to_json` wrote; throws nlohmann::json::exception for anything else.
UnitResult unit_from_json(const nlohmann::ordered_json& json);

} // namespace dfdyn::tools
