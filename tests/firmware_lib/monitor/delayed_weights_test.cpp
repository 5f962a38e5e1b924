// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/monitor/delayed_weights.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>

namespace delayed_weights_test {

using namespace dfdyn;

TEST_CASE("delayed weights are between one and two periods old", "[monitor]") {
    DelayedWeights<float, 2> held({});
    for (int period = 0; period < 5; ++period) {
        const auto now = static_cast<float>(10 + period);
        std::fill_n(held.refresh(), 2, now);
        CHECK(held.older()[0] == (period == 0 ? 0 : now - 1));
    }
}

} // namespace delayed_weights_test
