// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/monitor/centred_motion.hpp"

#include "tests/support/catch.hpp"

#include <array>

namespace centred_motion_test {

using namespace dfdyn;

TEST_CASE("centred rows give position, velocity and acceleration of a parabola exactly", "[monitor]") {
    constexpr int window = 6;
    std::array<double, 3 * (window + 1)> rows{};
    centred_motion_rows(window, 0.02, rows.data());
    std::array<double, 3> motion{};
    for (std::size_t lag = 0; lag <= window; ++lag) {
        const double t = 0.02 * (window / 2.0 - static_cast<double>(lag));
        for (std::size_t j = 0; j < 3; ++j) {
            motion[j] += rows[j * (window + 1) + lag] * (0.3 - 1.2 * t + 2.5 * t * t);
        }
    }
    CHECK(motion[0] == Approx(0.3));
    CHECK(motion[1] == Approx(-1.2));
    CHECK(motion[2] == Approx(5));
}

} // namespace centred_motion_test
