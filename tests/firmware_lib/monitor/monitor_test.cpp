// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/monitor/monitor.hpp"

#include "tests/firmware_lib/monitor/swinging_arm.hpp"
#include "tests/firmware_lib/support/counted.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace monitor_test {

using namespace dfdyn;
using namespace dfdyn::tests;
using namespace dfdyn::tests::monitored;

TEMPLATE_TEST_CASE("the monitor reports cause, place and size of a change without the heap", "[monitor]",
                   float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    const Cause cause = GENERATE(Cause::payload, Cause::friction, Cause::bias, Cause::contact, Cause::frozen);
    CAPTURE(name(cause));
    const auto fixed = constants<TestType>();
    TestMonitor<TestType> monitor(fixed);
    const double from_s = std::uniform_real_distribution<double>(20, 30)(engine);
    Swinging<TestType> arm({cause, from_s, cause == Cause::contact ? from_s + 1.5 : 1e9});
    const AllocationGuard guard;
    const int early = run(monitor, arm, from_s, engine);
    const int updates = run(monitor, arm, from_s + 30, engine);
    const HeapCalls calls = guard.calls();
    CHECK(calls.allocations == 0);
    REQUIRE(early == 0);
    REQUIRE(updates > 0);
    const auto& change = monitor.change();
    CHECK(name(change.cause) == std::string(name(cause)));
    CHECK(change.confidence > TestType(0.8));
    CHECK(1e-9 * static_cast<double>(change.alarm_ns) - from_s < 4);
    CHECK(std::abs(1e-9 * static_cast<double>(change.onset_ns) - from_s) < 1);
    switch (cause) {
    case Cause::payload:
        CHECK(change.size[0] == Approx(payload_mass).epsilon(0.2));
        CHECK(change.size[1] == Approx(payload_mass * (payload_x - tip_x)).epsilon(0.2));
        break;
    case Cause::friction:
        CHECK(change.where == 1);
        CHECK(change.size[0] == Approx(coulomb).epsilon(0.2));
        break;
    case Cause::bias:
        CHECK(change.where == 0);
        CHECK(change.bias[0] == Approx(moved).epsilon(0.2));
        CHECK(std::abs(change.bias[1]) < TestType(0.1));
        break;
    case Cause::contact:
        CHECK(change.where == -1);
        CHECK(change.size[0] == Approx(force_x).epsilon(0.5));
        break;
    default:
        CHECK(change.where == 3); // the second output
    }
}

TEST_CASE("a change that requires a payload without mass is not classified as a payload", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto fixed = constants<float>();
    TestMonitor<float> monitor(fixed);
    Swinging<float> arm({Cause::payload, 25, 1e9, true});
    REQUIRE(run(monitor, arm, 25, engine) == 0);
    REQUIRE(run(monitor, arm, 55, engine) > 0);
    CHECK(name(monitor.change().cause) != std::string(name(Cause::payload)));
}

TEST_CASE("no tick of the monitor exceeds its declared cost", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    using Scalar = Counted<double>;
    constexpr std::int64_t cost = TestMonitor<Scalar>::cost({}, lags);
    std::int64_t most = 0;
    int changes = 0;
    for (int arms = 0; arms < 10; ++arms) {
        const auto cause = static_cast<Cause>(1 + arms % (cause_count - 1));
        const auto fixed = constants<Scalar>();
        TestMonitor<Scalar> monitor(fixed);
        Swinging<Scalar> arm({cause, 25, cause == Cause::contact ? 26.5 : 1e9});
        bool changed = false;
        while (arm.time_s() < 50) {
            counted_operations = 0;
            arm.step(monitor, engine);
            most = std::max(most, counted_operations);
            changed = changed || monitor.changing();
        }
        changes += changed ? 1 : 0;
    }
    CHECK(changes >= 8);
    CAPTURE(most, cost);
    CHECK(most <= cost);
    CHECK(2 * most > cost); // and the bound is not far too large
}

} // namespace monitor_test
