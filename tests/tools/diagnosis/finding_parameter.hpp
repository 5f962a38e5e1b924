// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/catch.hpp"
#include "tools/diagnosis/diagnosis.hpp"

#include <algorithm>
#include <string>

namespace dfdyn::tests {

/// Returns the value of a finding's parameter. The test fails if it has none of this name.
inline double parameter(const tools::Finding& finding, const std::string& name) {
    const auto found = std::ranges::find(finding.parameters, name, &tools::FoundParameter::name);
    REQUIRE(found != finding.parameters.end());
    return found->value;
}

} // namespace dfdyn::tests
