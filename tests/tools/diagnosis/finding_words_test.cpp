// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/finding_words.hpp"

#include "tests/support/catch.hpp"

#include <string>
#include <utility>
#include <vector>

namespace finding_words_test {

using namespace dfdyn::tools;

std::string main_parameter(std::vector<FoundParameter> parameters) {
    Finding finding;
    finding.parameters = std::move(parameters);
    return main_parameter_words(finding);
}

TEST_CASE("a finding is told by what was measured, of several of a kind by what is known best") {
    CHECK(main_parameter({}).empty());
    CHECK(main_parameter({{"axis", "1", 2, 2, 2}}).empty());
    const FoundParameter no_mass{"delta_mass", "kg", 0, 0, 0};
    const FoundParameter along_x{"delta_com_x", "m", 0.005, -0.003, 0.013};
    const FoundParameter along_z{"delta_com_z", "m", 0.125, 0.115, 0.135};
    CHECK(main_parameter({no_mass, along_x, along_z}) == "delta_com_z 0.125 m (0.115 … 0.135)");
    CHECK(main_parameter({no_mass, along_z, along_x}) == "delta_com_z 0.125 m (0.115 … 0.135)");
    // an uncertain mass is not hidden behind a certain place
    CHECK(main_parameter({{"mass", "kg", 0.15, -0.1, 0.4}, along_z}) == "mass 0.15 kg (-0.1 … 0.4)");
    CHECK(main_parameter({{"start", "s", 8, 7, 9}, {"end", "s", 9, 8, 10}}) == "start 8 s (7 … 9)");
}

} // namespace finding_words_test
