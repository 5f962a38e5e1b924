// SPDX-License-Identifier: Apache-2.0
// Arms that are pushed at rest: the recordings are simulated, and the diagnosis sees nothing else.
#include "tests/diagnosis/panel/changes/push_panel.hpp"

#include "tests/support/catch.hpp"

#include <cmath>

namespace {

using namespace dfdyn::tests;

constexpr std::uint64_t first_seed = 501;
constexpr int cases = 4;

} // namespace

TEST_CASE("a push at rest is found if it exceeds friction and is not reported otherwise") {
    int strong = 0;
    int found = 0;
    for (const PushScore& score : run_push_panel(first_seed, cases, [](const PushScore&) {})) {
        INFO(describe(score));
        for (std::size_t i = 0; i < score.pushes.size(); ++i) {
            const double size = std::abs(score.pushes[i].peak) / score.pushes[i].held;
            strong += size > 2 ? 1 : 0;
            found += size > 2 && score.found[i] >= 0.5 ? 1 : 0;
            if (size < 0.7) {
                CHECK(score.found[i] < 0.5);
            }
        }
        for (const PushScore::Named& named : score.named) {
            CHECK((named.right || named.confidence < 0.5));
        }
    }
    REQUIRE(strong >= 5);
    CHECK(3 * found >= 2 * strong);
}
