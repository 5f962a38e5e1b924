// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/catch.hpp"
#include "tools/model/inputs/input_description.hpp"

#include <vector>

namespace dfdyn::tests {

/// Returns the inputs of the catalogue; requires those of the paper.
inline std::vector<tools::InputKind> all_inputs() {
    std::vector<tools::InputKind> kinds;
    for (const tools::InputDescription* const input : tools::input_catalogue()) {
        kinds.push_back(input->kind);
    }
    REQUIRE(kinds.size() >= 5);
    return kinds;
}

} // namespace dfdyn::tests
