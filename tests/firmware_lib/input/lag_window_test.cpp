// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/core/lag_window.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"

#include <array>
#include <deque>
#include <vector>

namespace lag_window_test {

using namespace dfdyn;
using Row = std::vector<double>;

Row random_row(std::mt19937_64& engine, int joints) {
    std::uniform_real_distribution<double> value(-3, 3);
    Row row(static_cast<std::size_t>(joints));
    for (double& element : row) {
        element = value(engine);
    }
    return row;
}

/// Returns true if the window contains exactly the rows of `expected`, newest first, in one block.
template <class Window>
bool holds(const Window& window, const std::deque<Row>& expected) {
    bool same = window.filled() == static_cast<int>(expected.size());
    for (int lag = 0; same && lag < window.filled(); ++lag) {
        const Row& row = expected[static_cast<std::size_t>(lag)];
        const double* const in_block = window.row(0) + lag * static_cast<int>(row.size());
        same = window.row(lag) == in_block && std::equal(row.begin(), row.end(), in_block);
    }
    return same;
}

template <int n, int M>
void compare_with_deque(std::mt19937_64& engine, Extent<n> joints, Extent<M> lags) {
    LagWindow<double, n, M> window(joints, lags);
    std::deque<Row> expected;
    bool same = true;
    for (int step = 0; step < 1000; ++step) {
        if (engine() % 50 == 0) {
            window.restart();
            expected.clear();
        }
        const Row row = random_row(engine, joints);
        window.push(row.data());
        expected.push_front(row);
        expected.resize(std::min(expected.size(), static_cast<std::size_t>(lags) + 1));
        same = same && holds(window, expected) && window.full() == (window.filled() == lags + 1);
    }
    CAPTURE(static_cast<int>(joints), static_cast<int>(lags));
    CHECK(window.capacity() == lags + 1);
    CHECK(same);
}

constexpr int newest_after_wrapping() {
    LagWindow<int, 1, 2> window({}, {});
    for (int value = 1; value <= 10; ++value) {
        window.push(&value);
    }
    return 100 * *window.row(0) + 10 * *window.row(1) + *window.row(2);
}

TEST_CASE("the window contains the last M+1 rows, newest first, in one block") {
    DFDYN_SEEDED_ENGINE(engine);
    compare_with_deque(engine, Extent<1>{}, Extent<0>{});
    compare_with_deque(engine, Extent<1>{}, Extent<1>{});
    compare_with_deque(engine, Extent<4>{}, Extent<10>{});
    compare_with_deque(engine, Extent<7>{}, Extent<20>{});
    compare_with_deque(engine, Extent<dynamic>{3}, Extent<dynamic>{5});
}

TEST_CASE("a new window is empty") {
    const LagWindow<float, 2, 3> window({}, {});
    CHECK(window.filled() == 0);
    CHECK_FALSE(window.full());
}

TEST_CASE("a window works in constant expressions") {
    STATIC_REQUIRE(newest_after_wrapping() == 10 * 100 + 9 * 10 + 8);
}

TEST_CASE("a window takes no more than twice its rows and two counters") {
    CHECK(sizeof(LagWindow<float, 4, 15>) <= 2 * 16 * 4 * sizeof(float) + 32);
}

} // namespace lag_window_test
