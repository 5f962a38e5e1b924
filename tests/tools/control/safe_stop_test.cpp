// SPDX-License-Identifier: Apache-2.0
#include "tools/control/safe_stop.hpp"

#include "tests/support/catch.hpp"

#include <functional>
#include <limits>
#include <utility>
#include <vector>

namespace safe_stop_test {

using namespace dfdyn::tools;

SafeStopConfig small_config() {
    SafeStopConfig config;
    config.position_patience = 3;
    config.deadline_patience = 2;
    config.following_error = JointVector::Constant(2, 0.1);
    config.ramp_ticks = 4;
    return config;
}

constexpr TickHealth healthy{true, false, false, false};
const JointVector no_error = JointVector::Zero(2);

SafeStop running() {
    SafeStop stop(small_config());
    REQUIRE(stop.tick(healthy, no_error) == LoopState::running);
    return stop;
}

TickHealth health(const std::function<void(TickHealth&)>& spoil) {
    TickHealth result = healthy;
    spoil(result);
    return result;
}

TEST_CASE("a loop waits for positions as long as it takes, then runs while all is well") {
    SafeStop stop(small_config());
    for (int tick = 0; tick < 100; ++tick) {
        CHECK(stop.tick({}, no_error) == LoopState::waiting);
    }
    for (int tick = 0; tick < 100; ++tick) {
        CHECK(stop.tick(healthy, no_error) == LoopState::running);
    }
    CHECK(stop.cause() == StopCause::none);
    CHECK(stop.hold_share() == 0);
}

TEST_CASE("a loop stops at the first tick beyond its patience, and not before") {
    const std::vector<std::pair<StopCause, std::function<void(TickHealth&)>>> faults{
        {StopCause::requested, [](TickHealth& h) { h.stop_requested = true; }},
        {StopCause::bus_lost, [](TickHealth& h) { h.bus_lost = true; }},
        {StopCause::no_position, [](TickHealth& h) { h.position_valid = false; }},
        {StopCause::missed_deadlines, [](TickHealth& h) { h.deadline_missed = true; }}};
    const std::vector<int> patience{0, 0, 3, 2};
    for (std::size_t i = 0; i < faults.size(); ++i) {
        CAPTURE(name(faults[i].first));
        SafeStop stop = running();
        const TickHealth faulty = health(faults[i].second);
        for (int tick = 0; tick < patience[i]; ++tick) {
            CHECK(stop.tick(faulty, no_error) == LoopState::running);
        }
        SafeStop recovered = stop;
        CHECK(stop.tick(faulty, no_error) == LoopState::stopping);
        CHECK(stop.cause() == faults[i].first);
        // in a row: one good tick starts the count again
        CHECK(recovered.tick(healthy, no_error) == LoopState::running);
        for (int tick = 0; tick < patience[i]; ++tick) {
            CHECK(recovered.tick(faulty, no_error) == LoopState::running);
        }
    }
}

TEST_CASE(
    "a joint too far from its reference stops the loop, to either side, or as soon as it is no number") {
    for (const double error : {0.11, -0.11, std::numeric_limits<double>::quiet_NaN()}) {
        SafeStop stop = running();
        CHECK(stop.tick(healthy, JointVector::Constant(2, 0.09)) == LoopState::running);
        JointVector errors = no_error;
        errors[1] = error;
        CHECK(stop.tick(healthy, errors) == LoopState::stopping);
        CHECK(stop.cause() == StopCause::following_error);
    }
}

TEST_CASE("stopping goes over to holding in equal steps, and nothing leads back") {
    SafeStop stop = running();
    stop.tick(health([](TickHealth& h) { h.bus_lost = true; }), no_error);
    for (const double share : {0.25, 0.5, 0.75}) {
        CHECK(stop.tick(healthy, no_error) == LoopState::stopping);
        CHECK(stop.hold_share() == share);
    }
    for (int tick = 0; tick < 10; ++tick) {
        CHECK(stop.tick(healthy, no_error) == LoopState::stopped);
        CHECK(stop.hold_share() == 1);
    }
    CHECK(stop.tick(health([](TickHealth& h) { h.stop_requested = true; }), no_error) == LoopState::stopped);
    CHECK(stop.cause() == StopCause::bus_lost);
}

TEST_CASE("who has not moved anything stops at once") {
    SafeStop asked(small_config());
    CHECK(asked.tick({false, false, false, true}, no_error) == LoopState::stopped);
    SafeStop elsewhere(small_config());
    CHECK(elsewhere.tick(healthy, JointVector::Constant(2, 1)) == LoopState::stopped);
    CHECK(elsewhere.cause() == StopCause::following_error);
}

} // namespace safe_stop_test
