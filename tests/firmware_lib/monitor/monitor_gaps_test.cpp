// SPDX-License-Identifier: Apache-2.0
#include "tests/firmware_lib/monitor/swinging_arm.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <limits>

namespace monitor_gaps_test {

using namespace dfdyn;
using namespace dfdyn::tests;
using namespace dfdyn::tests::monitored;

TEST_CASE("without a change the monitor reports nothing, also with gaps", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto fixed = constants<float>();
    TestMonitor<float> monitor(fixed);
    Swinging<float> arm({});
    for (int part = 0; part < 60; ++part) {
        CHECK(run(monitor, arm, 20.0 * (part + 1), engine) == 0);
        monitor.interrupt();
    }
}

TEST_CASE("samples with NaN count as gaps and the monitor continues", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto fixed = constants<float>();
    TestMonitor<float> monitor(fixed);
    Swinging<float> arm({Cause::bias, 60, 1e9});
    int early = 0;
    while (arm.time_s() < 60) {
        const bool faulty = engine() % 100 == 0;
        early += arm.step(monitor, engine, {faulty ? static_cast<int>(engine() % 4 + 1) : 0}) ? 1 : 0;
    }
    CHECK(early == 0);
    REQUIRE(run(monitor, arm, 80, engine) > 0);
    CHECK(name(monitor.change().cause) == std::string(name(Cause::bias)));
    CHECK(std::isfinite(monitor.change().confidence));
}

TEMPLATE_TEST_CASE("a spike of any size is not reported and does not delay the detection of a later change",
                   "[monitor]", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    const int kind = GENERATE(5, 6, 7, 8);
    const double size = GENERATE(1e6, 1e10, 1e15, 1e20, 1e25, 1e38, -3e38);
    const Cause cause = GENERATE(Cause::payload, Cause::bias, Cause::frozen);
    CAPTURE(kind, size, name(cause));
    const auto fixed = constants<TestType>();
    TestMonitor<TestType> monitor(fixed);
    constexpr double spike_s = 25;
    constexpr double from_s = 40;
    Swinging<TestType> arm({cause, from_s, 1e9});
    int early = run(monitor, arm, spike_s, engine);
    early += arm.step(monitor, engine, {kind, size}) ? 1 : 0;
    early += arm.step(monitor, engine, {kind == 8 ? kind : 0, -size}) ? 1 : 0;
    early += run(monitor, arm, from_s, engine);
    CHECK(early == 0);
    REQUIRE(run(monitor, arm, from_s + 30, engine) > 0);
    CHECK(name(monitor.change().cause) == std::string(name(cause)));
    CHECK(1e-9 * static_cast<double>(monitor.change().alarm_ns) - from_s < 4);
    CHECK(monitor.change().confidence > TestType(0.8));
}

TEST_CASE("after a restart no earlier sample causes an alarm", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto fixed = constants<double>();
    TestMonitor<double> monitor(fixed);
    Swinging<double> arm({Cause::bias, 40, 1e9});
    while (!monitor.changing() && arm.time_s() < 60) {
        arm.step(monitor, engine);
    }
    REQUIRE(monitor.changing());
    monitor.restart();
    CHECK_FALSE(monitor.changing());
    Swinging<double> sound({});
    CHECK(run(monitor, sound, 30, engine) == 0);
    CHECK_FALSE(monitor.changing());
}

} // namespace monitor_gaps_test
