// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/range.hpp"

#include "tests/support/catch.hpp"

#include <limits>

namespace range_test {

TEST_CASE("values beyond their ranges are rejected and counted") {
    dfdyn::hal::RangeGate<2> gate({{{-1, 2}, {0, 10}}});
    CHECK(gate.within({-1, 0}));
    CHECK(gate.within({2, 10}));
    CHECK(gate.count() == 0);
    CHECK_FALSE(gate.within({-1.001, 5}));
    CHECK_FALSE(gate.within({0, 10.001}));
    constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
    CHECK_FALSE(gate.within({not_a_number, 5}));
    CHECK_FALSE(gate.within({0, std::numeric_limits<double>::infinity()}));
    CHECK(gate.count() == 4);
}

} // namespace range_test
