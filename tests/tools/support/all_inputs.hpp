// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/inputs/input_description.hpp"

#include <vector>

namespace dfdyn::tests {

/// Returns the inputs of the catalogue.
inline std::vector<tools::InputKind> all_inputs() {
    std::vector<tools::InputKind> kinds;
    for (const tools::InputDescription* const input : tools::input_catalogue()) {
        kinds.push_back(input->kind);
    }
    return kinds;
}

} // namespace dfdyn::tests
