// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/staleness.hpp"

#include "tests/support/catch.hpp"

namespace staleness_test {

TEST_CASE("a value is valid up to its age limit, and then stale") {
    dfdyn::hal::StalenessGate gate(10);
    CHECK_FALSE(gate.stale(100, 100));
    CHECK_FALSE(gate.stale(100, 110));
    CHECK(gate.count() == 0);
    CHECK(gate.stale(100, 111));
    CHECK(gate.stale(100, 1000000));
    CHECK(gate.count() == 2);
    CHECK_FALSE(gate.stale(115, 111)); // measured after the sample time
}

} // namespace staleness_test
