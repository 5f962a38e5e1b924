// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/core/budget.hpp"

#include "tests/support/catch.hpp"

using dfdyn::Budget;

TEST_CASE("a budget affords a cost completely or not at all") {
    Budget budget{10};
    CHECK(budget.affords(10));
    CHECK_FALSE(budget.affords(11));
    CHECK_FALSE(budget.spend(11));
    CHECK(budget.operations == 10);
    CHECK(budget.spend(4));
    CHECK(budget.operations == 6);
    CHECK(budget.spend(6));
    CHECK(budget.operations == 0);
    CHECK_FALSE(budget.spend(1));
    CHECK(budget.spend(0));
}

TEST_CASE("an unlimited budget affords everything and a budget for prediction affords nothing") {
    CHECK_FALSE(Budget::predict_only().affords(1));
    CHECK(Budget::unlimited().affords(std::int64_t{1} << 62));
}
