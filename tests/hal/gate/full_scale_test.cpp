// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/full_scale.hpp"

#include "tests/support/catch.hpp"

#include <limits>

namespace full_scale_test {

using namespace dfdyn::hal;
using Gate = FullScaleGate<3>;

Gate complete_gate() {
    Gate gate({{{10, 5000}, {10, 5000}, {0.5, 500}}});
    gate.report(0, 1500);
    gate.report(1, 1500);
    gate.report(2, 35);
    return gate;
}

TEST_CASE("full scales are valid once all are known") {
    Gate gate({{{10, 5000}, {10, 5000}, {0.5, 500}}});
    for (const int channel : {2, 0, 1}) {
        CHECK(gate.reason() == Reason::waiting_for_full_scale);
        gate.report(channel, 100);
    }
    CHECK(gate.reason() == Reason::ok);
    CHECK(complete_gate()[2] == 35);
    CHECK(complete_gate().changed() == 0);
}

TEST_CASE("an implausible full scale is rejected, also before all are known") {
    Gate first({{{10, 5000}, {10, 5000}, {0.5, 500}}});
    first.report(1, 0);
    CHECK(first.reason() == Reason::full_scale_implausible);
    for (const double wrong : {0.0, 1e-20, -1500.0, 32767.0, std::numeric_limits<double>::quiet_NaN()}) {
        Gate gate = complete_gate();
        gate.report(1, wrong);
        CHECK(gate.reason() == Reason::full_scale_implausible);
        gate.report(1, 1500); // reported again
        CHECK(gate.reason() == Reason::full_scale_contradicted);
        gate.report(0, 1500);
        gate.report(2, 35);
        CHECK(gate.reason() == Reason::ok);
        CHECK(gate.changed() == 2);
    }
}

TEST_CASE("after a changed full scale, none is valid until all channels are reported again consistently") {
    Gate gate = complete_gate();
    gate.report(0, 500);
    CHECK(gate.reason() == Reason::full_scale_contradicted);
    gate.report(1, 1500);
    CHECK(gate.reason() == Reason::full_scale_contradicted);
    gate.report(0, 1500); // the other one again: all are required again
    gate.report(2, 35);
    CHECK(gate.reason() == Reason::full_scale_contradicted);
    gate.report(1, 1500);
    CHECK(gate.reason() == Reason::ok);
    CHECK(gate[0] == 1500);
}

TEST_CASE("described full scales are never replaced") {
    Gate gate({{{10, 5000}, {10, 5000}, {0.5, 500}}});
    gate.describe(0, 1500);
    gate.describe(1, 1500);
    gate.describe(2, 35);
    CHECK(gate.reason() == Reason::ok);
    gate.report(1, 500);
    gate.report(0, 1500);
    CHECK(gate.reason() == Reason::full_scale_contradicted);
    CHECK(gate[1] == 1500);
    CHECK(gate.changed() == 1);
    gate.report(1, 1500);
    CHECK(gate.reason() == Reason::ok);
}

TEST_CASE("a channel that the sensor does not have is ignored") {
    Gate gate = complete_gate();
    gate.report(-1, 0);
    gate.report(3, 0);
    CHECK(gate.reason() == Reason::ok);
}

} // namespace full_scale_test
