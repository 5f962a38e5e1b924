// SPDX-License-Identifier: Apache-2.0
// Response of the gate to pushes, changes and models that never fit.
#include "dfdyn/innovation_gate.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <limits>

namespace innovation_gate_test {

using namespace dfdyn;

constexpr float limit = 25;
constexpr int patience = 100;
constexpr float pushed = 100 * limit;
constexpr float plausible = 1;

using Gate = InnovationGate<float>;

TEST_CASE("the weight of a sample beyond the limit decreases with its distance down to zero") {
    Gate gate(limit, patience);
    CHECK(gate.judge(0) == 1);
    CHECK(gate.judge(limit) == 1);
    CHECK(gate.judge(2 * limit) == Approx(16));
    // after the alarm, in units of the ordinary contradiction
    CHECK(gate.judge(5 * limit) == Approx(15 * 15 * 15 * 15));
    CHECK(gate.judge(11 * limit) == 0);
    CHECK(gate.judge(std::numeric_limits<float>::infinity()) == 0);
}

TEST_CASE("the end of a push has little weight below the limit until the count returns to zero") {
    Gate gate(limit, patience);
    CHECK(gate.judge(0.9F * limit) == 1);
    CHECK(gate.judge(plausible) == 1);
    for (int t = 0; t < 10; ++t) {
        REQUIRE(gate.judge(pushed) == 0);
    }
    CHECK(gate.judge(0.9F * limit) == Approx(2.7 * 2.7 * 2.7 * 2.7));
    for (int t = 0; t < 11; ++t) {
        REQUIRE(gate.judge(plausible) == 1);
    }
    CHECK(gate.judge(0.9F * limit) == 1);
}

TEST_CASE("pushes shorter than the patience are not learned if the pauses are equally long") {
    Gate gate(limit, patience);
    for (int push = 0; push < 20; ++push) {
        for (int t = 0; t < patience; ++t) {
            REQUIRE(gate.judge(pushed) == 0);
        }
        for (int t = 0; t < patience; ++t) {
            REQUIRE(gate.judge(plausible) == 1);
        }
    }
    CHECK_FALSE(gate.change_pending());
}

TEST_CASE("a change is reported once, and every sample is learned until plausible ones dominate") {
    Gate gate(limit, patience);
    for (int t = 0; t < patience; ++t) {
        CHECK(gate.judge(pushed) == 0);
    }
    CHECK_FALSE(gate.take_change());
    CHECK(gate.judge(pushed) == 1);
    CHECK(gate.change_pending());
    CHECK(gate.take_change());
    CHECK_FALSE(gate.take_change());
    for (int t = 0; t < 10 * patience; ++t) {
        REQUIRE(gate.judge(t % 2 == 0 ? pushed : plausible) == 1); // equal numbers: the change does not end
    }
    for (int t = 0; t < Gate::settling * patience; ++t) {
        REQUIRE(gate.judge(plausible) == 1);
    }
    CHECK(gate.judge(1e6F * pushed) == 0);
}

TEST_CASE("a change reported by another detector is reported once and its samples keep their full weight") {
    Gate gate(1, patience);
    REQUIRE(gate.judge(pushed) == 0);
    gate.report_change();
    CHECK(gate.judge(pushed) == 1);
    CHECK(gate.take_change());
    CHECK_FALSE(gate.take_change());
}

TEST_CASE("plausible samples at reversals delay a change by their number and do not reset the count") {
    Gate gate(limit, patience);
    int refused = 0;
    int samples = 0;
    while (!gate.take_change()) {
        REQUIRE(++samples < 1000);
        const bool reversal = samples % 4 == 0;
        refused += gate.judge(reversal ? plausible : pushed) == 0 ? 1 : 0;
    }
    CHECK(samples == Approx(2 * patience).margin(4)); // each reversal delays by itself and one more sample
    CHECK(refused == Approx(1.5 * patience).margin(4));
}

TEST_CASE("a model that never fits is not reported as changed repeatedly") {
    DFDYN_SEEDED_ENGINE(engine);
    std::exponential_distribution<float> innovation(1 / (3 * limit));
    Gate gate(limit, patience);
    int changes = 0;
    int refused_late = 0;
    constexpr int samples = 1'000'000;
    for (int t = 0; t < samples; ++t) {
        const float noise_variance = gate.judge(innovation(engine));
        changes += gate.take_change() ? 1 : 0;
        refused_late += t > samples / 10 && noise_variance == 0 ? 1 : 0;
    }
    CHECK(changes >= 1);
    CHECK(changes < 30);
    CHECK(refused_late < samples / 1000);
}

TEST_CASE("a new motion begins with an empty count") {
    Gate gate(limit, patience);
    for (int t = 0; t < patience; ++t) {
        REQUIRE(gate.judge(pushed) == 0);
    }
    gate.restart();
    for (int t = 0; t < patience; ++t) {
        REQUIRE(gate.judge(pushed) == 0);
    }
    CHECK(gate.judge(pushed) == 1);
}

TEST_CASE("the largest patience never ends and zero or negative patience learns everything") {
    Gate patient(limit, std::numeric_limits<std::int32_t>::max());
    for (int t = 0; t < 100'000; ++t) {
        REQUIRE(patient.judge(pushed) == 0);
    }
    for (const std::int32_t none : {0, -1, std::numeric_limits<std::int32_t>::min()}) {
        Gate gate(limit, none);
        CHECK(gate.judge(pushed) == 1);
        CHECK_FALSE(gate.change_pending());
    }
}

TEST_CASE("a new motion does not discard an unreported change") {
    Gate gate(limit, patience);
    for (int t = 0; t <= patience; ++t) {
        static_cast<void>(gate.judge(pushed));
    }
    gate.restart();
    CHECK(gate.take_change());
}

TEST_CASE("a change reported before a motion begins keeps the full weight of the motion's samples") {
    Gate gate(limit, patience);
    gate.report_change(); // as by `relearn`, before the controller is activated
    gate.restart();
    CHECK(gate.judge(pushed) == 1);
    CHECK(gate.take_change());
    gate.restart(); // the change has been reported, but has not settled
    CHECK(gate.judge(pushed) == 1);
    for (int t = 0; t < 5 * patience; ++t) {
        static_cast<void>(gate.judge(plausible));
    }
    gate.restart();
    CHECK(gate.judge(pushed) == 0);
    Gate without(limit, 0);
    without.report_change();
    without.restart();
    CHECK(without.change_pending());
}

TEST_CASE("after a fault of any size and length the gate detects pushes again within a bounded time") {
    Gate gate(limit, patience);
    for (int t = 0; t < 100 * patience; ++t) {
        static_cast<void>(gate.judge(1e30F));
    }
    int patiences = 0;
    for (; Gate(gate).judge(pushed) == 1; ++patiences) {
        REQUIRE(patiences < 5000);
        for (int t = 0; t < patience; ++t) {
            REQUIRE(gate.judge(plausible) == 1);
        }
    }
    CHECK(patiences > 4); // the change has ended before
}

TEST_CASE("an invalid limit makes every sample a contradiction") {
    for (const float none : {0.F, -1.F, -std::numeric_limits<float>::infinity(), std::nanf("")}) {
        Gate gate(none, patience);
        for (int t = 0; t < patience; ++t) {
            REQUIRE(gate.judge(0) == 0);
        }
        CHECK(gate.judge(0) == 1);
    }
}

} // namespace innovation_gate_test
