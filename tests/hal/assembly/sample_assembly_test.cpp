// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/sample_assembly.hpp"

#include "tests/hal/support/arm_on_bus.hpp"

namespace sample_assembly_test {

namespace hal = dfdyn::hal;
using namespace dfdyn::tests;

TEST_CASE("an estimator learns from an arm on a bus at every tick after qualification") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    CHECK(arm.tick().position() == hal::Reason::history_too_short);
    for (int tick = 1; tick < ArmOnBus::qualification_ticks; ++tick) {
        CHECK(arm.tick().position() == hal::Reason::qualifying);
    }
    CHECK(arm.ticks_to_recover() == ArmOnBus::lags);
    CHECK(arm.run(500));
    const hal::AssemblyCounters& counters = arm.assembly.counters();
    CHECK(counters.calls == 511 + ArmOnBus::lags);
    CHECK(counters.samples == counters.outputs);
    CHECK(counters.positions_refused[static_cast<int>(hal::Reason::qualifying)] == 9);
    CHECK(arm.assembly.bus().unknown.count() == 0);
    CHECK(arm.assembly.bus().rejected.count() == 0);
    CHECK_FALSE(arm.assembly.colliding_id().has_value());
}

} // namespace sample_assembly_test
