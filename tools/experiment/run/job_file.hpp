// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan_data.hpp"
#include "tools/experiment/run/job_result.hpp"

#include <filesystem>
#include <optional>

namespace dfdyn::tools {

/// Returns all inputs of a job's result, for comparison: case, seed, protocol, checksums of the recordings
/// (and of the robot's file), and the program's build flags and, if readable, its checksum.
nlohmann::ordered_json job_inputs(const Plan& plan, const PlanData& data, const Case& one,
                                  std::uint64_t seed);

/// Writes a job's result and inputs atomically, and creates the folder. Returns the result as `read_job`
/// will return it. Throws InputError if this fails.
JobResult write_job(const std::filesystem::path& path, const nlohmann::ordered_json& inputs,
                    const JobResult& result);

/// Returns the result in `path` if its inputs are equal; nothing if they differ or the file does not exist.
std::optional<JobResult> read_job(const std::filesystem::path& path, const nlohmann::ordered_json& inputs);

} // namespace dfdyn::tools
