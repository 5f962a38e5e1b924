// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/safe_stop.hpp"

#include "tests/support/catch.hpp"

#include <functional>
#include <limits>
#include <optional>
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

constexpr TickHealth healthy{true, false, false, false, false, StopCause::none};
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

TEST_CASE("a loop waits for positions without a time limit and then runs while no fault occurs") {
    SafeStop stop(small_config());
    for (int tick = 0; tick < 100; ++tick) {
        CHECK(stop.tick({}, no_error) == LoopState::waiting);
    }
    for (int tick = 0; tick < 100; ++tick) {
        CHECK(stop.tick(healthy, no_error) == LoopState::running);
    }
    CHECK(stop.cause() == StopCause::none);
}

TEST_CASE("a loop stops at the first faulty tick beyond its patience and not before") {
    const std::vector<std::pair<StopCause, std::function<void(TickHealth&)>>> faults{
        {StopCause::requested, [](TickHealth& h) { h.stop_requested = true; }},
        {StopCause::bus_lost, [](TickHealth& h) { h.bus_lost = true; }},
        {StopCause::no_position, [](TickHealth& h) { h.position_valid = false; }},
        {StopCause::missed_deadlines, [](TickHealth& h) { h.deadline_missed = true; }},
        {StopCause::frozen_encoder, [](TickHealth& h) { h.joint = StopCause::frozen_encoder; }}};
    const std::vector<int> patience{0, 0, 3, 2, 0};
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
        // Only consecutive ticks count: one good tick restarts the count.
        CHECK(recovered.tick(healthy, no_error) == LoopState::running);
        for (int tick = 0; tick < patience[i]; ++tick) {
            CHECK(recovered.tick(faulty, no_error) == LoopState::running);
        }
    }
}

TEST_CASE("a following error beyond the limit in either direction or NaN stops the loop") {
    for (const double error : {0.11, -0.11, std::numeric_limits<double>::quiet_NaN()}) {
        SafeStop stop = running();
        CHECK(stop.tick(healthy, JointVector::Constant(2, 0.09)) == LoopState::running);
        JointVector errors = no_error;
        errors[1] = error;
        CHECK(stop.tick(healthy, errors) == LoopState::stopping);
        CHECK(stop.cause() == StopCause::following_error);
        CHECK(stop.joint() == 1);
    }
}

TEST_CASE("the joint of a stop is known if a joint caused it") {
    for (const auto& [cause, known] : {std::pair(StopCause::overspeed, true),
                                       {StopCause::frozen_encoder, true},
                                       {StopCause::torque_limit, true},
                                       {StopCause::finding, false}}) {
        SafeStop stop = running();
        CHECK_FALSE(stop.joint().has_value());
        stop.tick(health([&, &found = cause](TickHealth& h) {
                      h.joint = found;
                      h.joint_number = 1;
                  }),
                  no_error);
        CHECK(stop.cause() == cause);
        CHECK(stop.joint().value_or(-1) == (known ? 1 : -1));
    }
}

TEST_CASE("lost positions name the joint that is silent alone") {
    for (const std::optional<Eigen::Index> silent : {std::optional<Eigen::Index>(1), {}}) {
        SafeStop stop = running();
        for (int tick = 0; tick < 10; ++tick) {
            stop.tick(health([&](TickHealth& h) {
                          h.position_valid = false;
                          h.silent_joint = silent;
                      }),
                      no_error);
        }
        CHECK(stop.cause() == StopCause::no_position);
        CHECK(stop.joint() == silent);
    }
}

TEST_CASE("returning devices that still qualify have a patience of their own in addition to lost cycles") {
    SafeStop stop = running();
    const TickHealth lost = health([](TickHealth& h) { h.position_valid = false; });
    const TickHealth returning = health([](TickHealth& h) {
        h.position_valid = false;
        h.returning = true;
    });
    for (int tick = 0; tick < small_config().position_patience; ++tick) {
        CHECK(stop.tick(lost, no_error) == LoopState::running);
    }
    for (int tick = 0; tick < small_config().return_patience; ++tick) {
        CHECK(stop.tick(returning, no_error) == LoopState::running);
    }
    SafeStop back = stop;
    CHECK(back.tick(healthy, no_error) == LoopState::running);
    CHECK(back.tick(lost, no_error) == LoopState::running);
    SafeStop lost_again = stop;
    CHECK(lost_again.tick(lost, no_error) == LoopState::stopping);
    CHECK(stop.tick(returning, no_error) == LoopState::stopping);
    CHECK(stop.cause() == StopCause::no_position);
}

TEST_CASE("ticks in which different joints lack a reading do not add up and those of one joint do") {
    SafeStop stop = running();
    for (int tick = 0; tick < 100; ++tick) { // each joint has a reading in every second tick
        CHECK(stop.tick(health([&](TickHealth& h) {
                            h.position_valid = false;
                            h.longest_silence = 1;
                            h.returning = tick % 2 == 0;
                        }),
                        no_error) == LoopState::running);
    }
    const int patience = small_config().position_patience;
    for (int silence = 1; silence <= patience + 1; ++silence) {
        const LoopState expected = silence <= patience ? LoopState::running : LoopState::stopping;
        CHECK(stop.tick(health([&](TickHealth& h) {
                            h.position_valid = false;
                            h.longest_silence = silence;
                        }),
                        no_error) == expected);
    }
    CHECK(stop.cause() == StopCause::no_position);
}

TEST_CASE("a stopping loop is stopped after the ramp and never runs again") {
    SafeStop stop = running();
    stop.tick(health([](TickHealth& h) { h.bus_lost = true; }), no_error);
    for (int tick = 1; tick < small_config().ramp_ticks; ++tick) {
        CHECK(stop.tick(healthy, no_error) == LoopState::stopping);
    }
    for (int tick = 0; tick < 10; ++tick) {
        CHECK(stop.tick(healthy, no_error) == LoopState::stopped);
    }
    CHECK(stop.tick(health([](TickHealth& h) { h.stop_requested = true; }), no_error) == LoopState::stopped);
    CHECK(stop.cause() == StopCause::bus_lost);
}

TEST_CASE("a loop that has not yet moved the arm stops at once") {
    SafeStop asked(small_config());
    CHECK(asked.tick({false, false, false, true, false, StopCause::none}, no_error) == LoopState::stopped);
    SafeStop elsewhere(small_config());
    CHECK(elsewhere.tick(healthy, JointVector::Constant(2, 1)) == LoopState::stopped);
    CHECK(elsewhere.cause() == StopCause::following_error);
}

} // namespace safe_stop_test
