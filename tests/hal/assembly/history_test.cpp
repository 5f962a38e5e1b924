// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/assembly/history.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>

namespace history_test {

using dfdyn::hal::Measurement;
using History = dfdyn::hal::History<1, 4>;

bool push(History& history, std::int64_t stamp_ns) {
    return history.push({stamp_ns, dfdyn::hal::Reason::ok, {static_cast<double>(stamp_ns)}});
}

TEST_CASE("a history returns the neighbours of any time that it covers") {
    History history;
    CHECK(history.around(0).before == nullptr);
    CHECK(history.around(0).after == nullptr);
    for (int count = 1; count <= 11; ++count) { // wraps more than once
        REQUIRE(push(history, 10 * count));
        const int oldest = std::max(1, count - 3);
        for (int instant = 0; instant <= 10 * count + 5; ++instant) {
            const auto [before, after] = history.around(instant);
            const int last = instant / 10;
            CHECK((before == nullptr) == (last < oldest));
            CHECK((after == nullptr) == (last >= count));
            if (before != nullptr) {
                CHECK(before->stamp_ns == 10 * last);
            }
            if (after != nullptr) {
                CHECK(after->stamp_ns == 10 * std::max(last + 1, oldest));
            }
        }
    }
}

TEST_CASE("a history ignores entries that are not later than the newest") {
    History history;
    CHECK(push(history, -5));
    CHECK(push(history, 10));
    CHECK_FALSE(push(history, 10));
    CHECK_FALSE(push(history, 9));
    CHECK(history.newest().stamp_ns == 10);
    CHECK(history.around(9).before->stamp_ns == -5);
}

TEST_CASE("values between two measurements are interpolated linearly") {
    const Measurement<2> before{100, dfdyn::hal::Reason::ok, {1, -8}};
    const Measurement<2> after{300, dfdyn::hal::Reason::ok, {3, 0}};
    const Measurement<2> between = interpolate(before, after, 150);
    CHECK(between.stamp_ns == 150);
    CHECK(between.value[0] == Approx(1.5));
    CHECK(between.value[1] == Approx(-6));
}

} // namespace history_test
