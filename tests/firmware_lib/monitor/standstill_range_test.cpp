// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/monitor/standstill_range.hpp"

#include "tests/support/catch.hpp"

#include <limits>

namespace standstill_range_test {

using Range = dfdyn::StandstillRange<double>;

/// Adds a standstill of `blocks` blocks and the motion after it. One of the blocks reaches `level` and
/// `change`.
void stop(Range& range, double level, double change, int blocks = 10, bool alarm = false) {
    for (int block = 0; block < blocks; ++block) {
        const double share = block == blocks / 2 ? 1 : 0.1;
        range.add(share * level, share * change, alarm);
    }
    range.end();
}

Range known(double level, double change) {
    Range range;
    for (int standstill = 0; standstill < 100; ++standstill) {
        stop(range, level, change);
    }
    return range;
}

TEST_CASE("the range is known after four standstills and has a margin for unseen values", "[monitor]") {
    Range range;
    for (int standstill = 0; standstill < 4; ++standstill) {
        CHECK_FALSE(range.known());
        stop(range, 1 + 0.1 * standstill, 0.3);
    }
    REQUIRE(range.known());
    CHECK(range.level() == Approx(1.3 * 1.5));
    CHECK(range.change() == Approx(0.3 * 1.5));
    for (int standstill = 0; standstill < 200; ++standstill) {
        stop(range, 1.3, 0.3);
    }
    CHECK(range.level() == Approx(1.3 * 1.04));
}

TEST_CASE("one standstill of any length counts once and minutes at rest do not narrow the range",
          "[monitor]") {
    Range fresh;
    stop(fresh, 1, 0.3, 6000);
    CHECK_FALSE(fresh.known());
    Range range = known(1, 0.3);
    const double before = range.level();
    stop(range, 0.01, 0.01, 6000);
    CHECK(range.level() > 0.97 * before);
}

TEST_CASE("a wider standstill widens the range at once, narrower ones narrow it slowly", "[monitor]") {
    Range range = known(1, 0.3);
    stop(range, 2, 0.3);
    CHECK(range.level() == Approx(2 * 1.04));
    for (int standstill = 0; standstill < 50; ++standstill) {
        stop(range, 1, 0.3);
    }
    CHECK(range.level() < 1.5 * 1.04);
    CHECK(range.level() > 1.2 * 1.04);
}

TEST_CASE("an alarm widens the range by at most half and does not narrow it", "[monitor]") {
    Range range = known(1, 0.3);
    stop(range, 5, 0.01, 10, true);
    CHECK(range.level() == Approx(1.5 * 1.04));
    CHECK(range.change() == Approx(0.3 * 1.04));
}

TEST_CASE("an absurd block does not make the range unusable", "[monitor]") {
    Range range = known(1, 0.3);
    for (const double absurd :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e30}) {
        range.add(absurd, absurd, false);
        range.end();
        CHECK(range.level() <= 1.04);
    }
    range.add(1e12, 1e12, false);
    range.end();
    CHECK(range.level() == Approx(10 * 1.04).epsilon(0.1));
}

} // namespace standstill_range_test
