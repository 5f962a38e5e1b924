// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/bus.hpp"

#include "tests/support/catch.hpp"

#include <type_traits>

using dfdyn::hal::Frame;

TEST_CASE("a frame is trivially copyable and has its documented size") {
    STATIC_REQUIRE(std::is_trivially_copyable_v<Frame>);
    CHECK(sizeof(Frame) == 88);
}
