// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/instant.hpp"

#include "tests/support/catch.hpp"

TEST_CASE("times since 1970 are dates and other times are seconds") {
    using dfdyn::tools::instant_text;
    CHECK(instant_text(12.5) == "12.50 s");
    CHECK(instant_text(-0.25) == "-0.25 s");
    CHECK(instant_text(999'999'999) == "999999999.00 s");
    CHECK(instant_text(1'700'000'000.25) == "2023-11-14 22:13:20.25 UTC");
    CHECK(instant_text(1'699'999'999.996) == "2023-11-14 22:13:20.00 UTC"); // rounded into the next second
    CHECK_FALSE(dfdyn::tools::is_epoch_time(999'999'999));
    CHECK(dfdyn::tools::is_epoch_time(1e9));
}
