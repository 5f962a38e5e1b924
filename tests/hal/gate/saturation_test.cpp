// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/saturation.hpp"

#include "tests/support/catch.hpp"

#include <array>

namespace saturation_test {

using Raw = std::array<std::int32_t, 3>;

TEST_CASE("a reading is saturated if the device reports it or a raw value is at its end") {
    dfdyn::hal::SaturationGate gate;
    CHECK_FALSE(gate.saturated(false, Raw{0, 32766, -32766}));
    CHECK(gate.saturated(true, Raw{0, 0, 0}));
    CHECK(gate.saturated(false, Raw{0, 0, 32767}));
    CHECK(gate.saturated(false, Raw{-32768, 0, 0}));
    CHECK_FALSE(gate.saturated(false, Raw{0, 0, 0}));
    CHECK(gate.saturated(false, Raw{0, -32767, 0}));
    CHECK(gate.count() == 4);
    CHECK(gate.episodes() == 2);
}

} // namespace saturation_test
