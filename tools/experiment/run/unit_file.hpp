// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan_data.hpp"
#include "tools/experiment/run/unit_result.hpp"

#include <filesystem>
#include <optional>

namespace dfdyn::tools {

/// Everything that a unit's result depends on, for a comparison: case, seed, protocol, checksums of the
/// recordings (and of the robot's file), program: its build flags and, where it can be read, its checksum.
nlohmann::ordered_json unit_inputs(const Plan& plan, const PlanData& data, const Case& one,
                                   std::uint64_t seed);

/// Writes a unit's result beside its inputs, whole or not at all; makes the folder. Returns the result as
/// `read_unit` will give it. Throws InputError when it cannot.
UnitResult write_unit(const std::filesystem::path& path, const nlohmann::ordered_json& inputs,
                      const UnitResult& result);

/// The result in `path` if its inputs are these; nothing if they are not, or there is no such file.
std::optional<UnitResult> read_unit(const std::filesystem::path& path, const nlohmann::ordered_json& inputs);

} // namespace dfdyn::tools
