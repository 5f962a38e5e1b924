// SPDX-License-Identifier: Apache-2.0
// Sources without a description: a period is inferred only for those that keep one.
#include "tests/tools/can/recognition/made_motors.hpp"

namespace inferred_period_test {

using namespace dfdyn::tests;

TEST_CASE("bursts of several motors on one identifier are no regular sequence") {
    CHECK(rules(std::nullopt, made::cubemars(1, 6, false, 33).frames()) == Names{}); // answers on 0
    made::Log polled;
    for (int i = 0; i < 400; ++i) {
        for (unsigned k = 1; k <= 8; ++k) {
            polled.add(i / 200.0 + 280e-6 * k, 0x7FF, {made::byte(k), 0, 0xCC, 0, 0, 0, 0, 0});
        }
    }
    CHECK(rules(std::nullopt, polled.frames()) == Names{});
}

TEST_CASE("a pause among the first frames of a regular source does not hide its losses") {
    made::Log log;
    for (int i = 0; i < 1000; ++i) {
        if (i % 50 != 40) {
            log.add(i / 100.0 + (i < 10 ? 0 : 0.2), 0x123, {made::byte(static_cast<unsigned>(i)), 0});
        }
    }
    CHECK(rules(std::nullopt, log.frames()).contains("lost_frames"));
}

TEST_CASE("a source that nobody described has not stopped because of a few periods without it") {
    made::Log log;
    for (int i = 0; i < 2000; ++i) {
        log.add(i / 1000.0, 0x100, {0, 1});
        if (i < 1980) {
            log.add(i / 1000.0 + 300e-6, 0x200, {0, 1});
        }
    }
    CHECK(rules(std::nullopt, log.frames()) == Names{});
}

} // namespace inferred_period_test
