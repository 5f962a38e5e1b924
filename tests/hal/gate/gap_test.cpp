// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/gap.hpp"

#include "tests/support/catch.hpp"

namespace gap_test {

TEST_CASE("a gap between two values is detected and counted") {
    dfdyn::hal::GapGate gate(10);
    CHECK_FALSE(gate.ends(1'000'000)); // the first
    CHECK_FALSE(gate.ends(1'000'010));
    CHECK(gate.ends(1'000'021));
    CHECK(gate.ends(1'000'100));
    CHECK_FALSE(gate.ends(1'000'101));
    CHECK(gate.count() == 2);
    CHECK(gate.longest_ns() == 79);
    CHECK(gate.between(5, 16));
    CHECK_FALSE(gate.between(5, 15));
}

} // namespace gap_test
