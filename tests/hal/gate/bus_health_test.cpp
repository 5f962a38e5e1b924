// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/bus_health.hpp"

#include "tests/support/catch.hpp"

namespace bus_health_test {

using namespace dfdyn::hal;

TEST_CASE("a bus that receives nothing reports the reason") {
    BusHealth health;
    CHECK(health.reason() == Reason::ok);
    health.update(BusState::off, {});
    CHECK(health.reason() == Reason::bus_off);
    health.update(BusState::interface_down, {});
    CHECK(health.reason() == Reason::interface_down);
    health.update(BusState::active, {});
    CHECK(health.reason() == Reason::ok);
}

TEST_CASE("an error-passive bus is degraded but valid") {
    BusHealth health;
    CHECK_FALSE(health.degraded());
    for (const BusState state : {BusState::warning, BusState::passive}) {
        health.update(state, {});
        CHECK(health.degraded());
        CHECK(health.reason() == Reason::ok);
    }
    health.update(BusState::off, {});
    CHECK_FALSE(health.degraded());
}

TEST_CASE("lost frames are reported once, and counted from the start") {
    BusHealth health;
    BusCounters counters;
    counters.dropped = 1000; // before the first update
    health.update(BusState::active, counters);
    CHECK_FALSE(health.take_loss());
    counters.dropped = 1003;
    health.update(BusState::active, counters);
    health.update(BusState::active, counters);
    CHECK(health.take_loss());
    CHECK_FALSE(health.take_loss());
    counters.controller_overruns = 1;
    health.update(BusState::active, counters);
    CHECK(health.take_loss());
    health.device_lost();
    CHECK(health.take_loss());
    CHECK(health.losses() == 5);
}

TEST_CASE("lost arbitration, refused sends and error frames are not counted as losses") {
    BusHealth health;
    BusCounters counters;
    health.update(BusState::active, counters);
    counters.lost_arbitrations = 100000;
    counters.send_refused = 5;
    counters.error_frames = 100000;
    counters.saturated_drains = 3;
    health.update(BusState::active, counters);
    CHECK_FALSE(health.take_loss());
    CHECK(health.losses() == 0);
    CHECK(health.reason() == Reason::ok);
}

} // namespace bus_health_test
