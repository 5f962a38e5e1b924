// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/scenario/scenario_reader.hpp"

#include <string>
#include <vector>

namespace dfdyn::tests {

/// Reads the JSON `faults` of a scenario whose loop runs at 1 kHz.
inline std::vector<tools::Fault> faults_of(const std::string& faults, int joints) {
    const nlohmann::json json = tools::parse_json(R"({"faults": )" + faults + "}", "s.json");
    return tools::read_faults({tools::JsonReader(json, "s.json"), joints}, 0.001);
}

} // namespace dfdyn::tests
