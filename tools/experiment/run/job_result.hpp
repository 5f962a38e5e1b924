// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Result of one case with one draw of random features.
struct JobResult {
    std::string case_name;
    std::uint64_t seed = 0; ///< of the draw
    double sample_period_s = 0;
    /// [group][subset][tick]: the index ε of the T samples after the tick, averaged over the group's outputs.
    /// In a job's file: NaN without a value, infinite if an output that is the scale remains 0. After
    /// `keep_common_ticks`: as described there.
    std::vector<std::vector<std::vector<double>>> error;
    std::vector<double> normalised_error; ///< one-step nRMSE of each output over all subsets
    double median_us = 0;                 ///< of the ticks with learning
    std::int64_t operations = 0;          ///< multiply-adds of a tick with learning
    std::size_t state_bytes = 0;
    int columns = 0; ///< of the learner
};

/// Returns the result as JSON, with six digits for errors; null for NaN, "inf" for infinite.
nlohmann::ordered_json job_to_json(const JobResult& result);

/// Reads the output of `job_to_json`. Throws nlohmann::json::exception for anything else.
JobResult unit_from_json(const nlohmann::ordered_json& json);

} // namespace dfdyn::tools
