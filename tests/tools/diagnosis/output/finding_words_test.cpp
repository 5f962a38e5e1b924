// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/finding_words.hpp"

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

TEST_CASE(
    "the main parameter of a vector is its most certain coordinate and a mass comes before a position") {
    CHECK(main_parameter({}).empty());
    CHECK(main_parameter({{"axis", "1", 2, 2, 2}}).empty());
    const FoundParameter no_mass{"delta_mass", "kg", 0, 0, 0};
    const FoundParameter along_x{"delta_com_x", "m", 0.005, -0.003, 0.013};
    const FoundParameter along_z{"delta_com_z", "m", 0.125, 0.115, 0.135};
    CHECK(main_parameter({no_mass, along_x, along_z}) == "delta_com_z 0.125 m (0.115 … 0.135)");
    CHECK(main_parameter({no_mass, along_z, along_x}) == "delta_com_z 0.125 m (0.115 … 0.135)");
    // An uncertain error of a mass comes after a certain one of its centre.
    CHECK(main_parameter({{"delta_mass", "kg", -0.158, -1.32, 1}, along_z}) ==
          "delta_com_z 0.125 m (0.115 … 0.135)");
    // An uncertain mass comes before a certain position.
    CHECK(main_parameter({{"mass", "kg", 0.15, -0.1, 0.4}, along_z}) == "mass 0.15 kg (-0.1 … 0.4)");
    CHECK(main_parameter({{"amplitude", "rad", 0.2, 0.1, 0.3}, {"phase", "rad", 1.8, 1.7, 1.9}}) ==
          "amplitude 0.2 rad (0.1 … 0.3)");
    CHECK(main_parameter({{"coulomb", "N·m", 2, 1, 3}, {"static", "N·m", 4, 3.9, 4.1}}) ==
          "coulomb 2 N·m (1 … 3)");
    CHECK(
        main_parameter({{"start", "s", 8, 7.9, 8.1}, {"end", "s", 9, 8.9, 9.1}, {"peak", "N", 30, 20, 40}}) ==
        "peak 30 N (20 … 40)");
    CHECK(main_parameter({{"coulomb_pos", "N·m", 0.2, -0.1, 0.5}, {"coulomb_neg", "N·m", 3, 2.8, 3.2}}) ==
          "coulomb_neg 3 N·m (2.8 … 3.2)");
}

TEST_CASE("of many indistinguishable causes the closest three are named and the others are counted") {
    Finding finding;
    for (const char* const where : {"link5", "link4", "link3", "link2", "link1"}) {
        finding.indistinguishable.push_back({"link_inertia_error", where, {}});
    }
    const std::string three =
        "link inertia error at link5; link inertia error at link4; link inertia error at link3";
    CHECK(tie_words(finding) == three + "; 2 others");
    finding.indistinguishable.pop_back();
    CHECK(tie_words(finding) == three + "; 1 other");
    finding.indistinguishable.pop_back();
    CHECK(tie_words(finding) == three);
}

} // namespace finding_words_test
