// SPDX-License-Identifier: Apache-2.0
#include "tools/model/output_units.hpp"

#include "tests/support/catch.hpp"

namespace output_units_test {

using namespace dfdyn::tools;
using Units = std::vector<std::string>;

TEST_CASE("an output at a prismatic joint is a force") {
    ChainModel chain;
    chain.joints.resize(2);
    chain.joints.back().prismatic = true;
    CHECK(output_units({"tau1", "tau2"}, &chain) == Units{"N·m", "N"});
    CHECK(output_units({"tau1", "tau2"}, nullptr) == Units{"N·m", "N·m"});
    CHECK(output_units({"i1", "i2"}, &chain) == Units{"A", "A"});
    chain.sensor.emplace();
    CHECK(output_units({"fx", "fy", "fz", "mx", "my", "mz"}, &chain) ==
          Units{"N", "N", "N", "N·m", "N·m", "N·m"});
}

} // namespace output_units_test
