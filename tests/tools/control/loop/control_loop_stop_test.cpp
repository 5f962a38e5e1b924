// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/control/loop/loop_bench.hpp"
#include "tools/control/loop/control_loop.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace control_loop_stop_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Bench = LoopBench;

TEST_CASE("a loop without positions coasts and then ramps to the weight at the last position") {
    Bench bench(pendulum_scenario(), no_observer);
    for (int tick = 0; tick < 50; ++tick) {
        bench.tick();
    }
    double before = bench.tick();
    for (int tick = 0; tick < 5; ++tick) {
        before = bench.tick(false);
        CHECK(bench.loop().state() == LoopState::running);
    }
    CHECK(bench.loop().counters().coasted == 5);
    const double start = bench.tick(false);
    CHECK(bench.loop().state() == LoopState::stopping);
    CHECK(bench.loop().counters().coasted == 5); // the tick that stops does not follow the reference
    CHECK(bench.loop().cause() == StopCause::no_position);
    CHECK(start == Approx(before).margin(0.1)); // continues without a jump
    double last = start;
    for (int tick = 0; tick < 300; ++tick) {
        const double next = bench.tick(false);
        CHECK(std::abs(next - last) <= 0.2 + 1e-9); // 20 N·m in 0.1 s
        last = next;
    }
    CHECK(bench.loop().state() == LoopState::stopped);
    CHECK(last == Approx(weight(bench.position()[0])).epsilon(1e-6));
}

TEST_CASE("an arm that drifts while the loop holds it is damped and pulled back") {
    Bench bench(pendulum_scenario());
    for (int tick = 0; tick < 20; ++tick) {
        bench.tick();
    }
    bench.tick(true, true);
    for (int tick = 0; tick < 300; ++tick) {
        bench.tick(true, true);
    }
    REQUIRE(bench.loop().state() == LoopState::stopped);
    double torque = 0;
    const double rest = bench.position()[0];
    for (int tick = 0; tick < 60; ++tick) {
        bench.position()[0] += 0.001 * std::min(1.0, 0.1 * tick); // up to 1 rad/s
        torque = bench.tick(true, true);
    }
    const double spring = 50 * (bench.position()[0] - rest);
    CHECK(torque == Approx(weight(bench.position()[0]) - 5 * 1.0 - spring).epsilon(1e-3));
}

TEST_CASE("after a stop damping follows positions that return and ends when they are lost again") {
    Bench bench(pendulum_scenario());
    for (int tick = 0; tick < 50; ++tick) {
        bench.tick();
    }
    for (int tick = 0; tick < 300; ++tick) {
        bench.tick(false);
    }
    REQUIRE(bench.loop().cause() == StopCause::no_position);
    double torque = 0;
    for (int tick = 0; tick < 30; ++tick) {
        bench.position()[0] += 0.001; // 1 rad/s
        torque = bench.tick();
    }
    CHECK(torque < weight(bench.position()[0]) - 3);
    for (int tick = 0; tick < 300; ++tick) {
        torque = bench.tick(false); // the positions are lost again
    }
    CHECK(torque == Approx(weight(bench.position()[0])).margin(0.5)); // it came to rest within 0.1 rad
}

TEST_CASE("the loop requests brakes when the arm rests or positions fail and goes limp only in limp mode") {
    for (const StopMode mode : {StopMode::hold, StopMode::limp}) {
        for (const bool blind : {false, true}) {
            CAPTURE(static_cast<int>(mode), blind);
            Bench bench(pendulum_scenario(), {{}, {}, mode});
            for (int tick = 0; tick < 50; ++tick) {
                bench.tick();
            }
            int requested = -1, limp = -1;
            double torque = 0;
            for (int tick = 0; tick < 1200; ++tick) {
                LoopInput input;
                input.bus_lost = tick == 0;
                torque = bench.tick(input, !blind);
                requested = requested < 0 && bench.loop().brake_requested() ? tick : requested;
                limp = limp < 0 && bench.loop().limp() ? tick : limp;
            }
            CHECK(requested == (blind ? 5 : 200)); // ticks without damping, or of the ramp
            CHECK(limp == (mode == StopMode::limp ? requested + 200 : -1));
            const bool ends = mode == StopMode::limp || blind; // blind for a second
            CHECK(torque == Approx(ends ? 0 : weight(bench.position()[0])).margin(0.01));
            CHECK(bench.loop().done() == ends);
        }
    }
}

constexpr double largest_step = 0.2; ///< N·m: 20 N·m in 0.1 s at 1 kHz

/// Ticks in which the torque goes from the weight to zero.
int release_ticks(Bench& bench) {
    return static_cast<int>(std::ceil(std::abs(weight(bench.position()[0])) / largest_step));
}

TEST_CASE("the loop is done once brakes are requested after a requested stop or after a second of silence") {
    Bench told(pendulum_scenario(), no_observer), silent(pendulum_scenario(), no_observer);
    for (int tick = 0; tick < 50; ++tick) {
        told.tick();
        silent.tick();
    }
    LoopInput lost;
    lost.bus_lost = true;
    const int release = release_ticks(told);
    REQUIRE(release > 5);
    for (int tick = 0; tick < 2000; ++tick) {
        told.tick(lost);
        CHECK_FALSE(told.loop().done());
        silent.tick(false);
        CHECK(silent.loop().done() == (tick + 2 >= 1000 + release));
    }
    for (int tick = 0; tick < release; ++tick) {
        CHECK_FALSE(told.loop().done());
        told.tick(true, true);
    }
    CHECK(told.loop().done());
    CHECK(told.loop().cause() == StopCause::bus_lost);
}

TEST_CASE("a position that returns while the torque goes to zero does not bring it back") {
    Bench bench(pendulum_scenario(), no_observer);
    for (int tick = 0; tick < 50; ++tick) {
        bench.tick();
    }
    for (int tick = 0; tick < 1005; ++tick) {
        bench.tick(false);
    }
    REQUIRE_FALSE(bench.loop().done());
    double torque = bench.tick();
    for (int tick = 0; tick < 200; ++tick) {
        const double before = torque;
        torque = bench.tick(tick % 3 == 0);
        CHECK(std::abs(torque) <= std::abs(before));
    }
    CHECK(torque == 0);
    CHECK(bench.loop().done());
}

TEST_CASE("a requested stop keeps the torque until the brakes had time to close and ends with none") {
    Bench bench(pendulum_scenario(), no_observer);
    for (int tick = 0; tick < 50; ++tick) {
        bench.tick();
    }
    int brakes = -1, done = -1;
    double torque = bench.tick();
    for (int tick = 0; tick < 1000 && done < 0; ++tick) {
        const double before = torque;
        torque = bench.tick(true, true);
        brakes = brakes < 0 && bench.loop().brake_requested() ? tick : brakes;
        done = bench.loop().done() ? tick : -1;
        CHECK(std::abs(torque - before) <= largest_step + 1e-9);
        if (brakes < 0 || tick < brakes + 200) { // 0.2 s
            CHECK(torque == Approx(weight(bench.position()[0])).margin(0.1));
        }
    }
    CHECK(brakes >= 0);
    CHECK(done == Approx(brakes + 199 + release_ticks(bench)).margin(1));
    CHECK(torque == 0);
}

TEST_CASE("every cause stops the loop within its patience and without a jump of the torque") {
    struct Fault {
        StopCause cause;
        int patience;
        LoopInput input;
        double displaced;
    };
    LoopInput requested, missed, lost;
    requested.stop_requested = true;
    missed.deadline_missed = true;
    lost.bus_lost = true;
    const std::vector<Fault> faults{{StopCause::requested, 0, requested, 0},
                                    {StopCause::missed_deadlines, 10, missed, 0},
                                    {StopCause::bus_lost, 0, lost, 0},
                                    {StopCause::following_error, 0, {}, 0.6}};
    for (const Fault& fault : faults) {
        CAPTURE(name(fault.cause));
        Bench bench(pendulum_scenario(), no_observer);
        for (int tick = 0; tick < 50; ++tick) {
            bench.tick();
        }
        double last = bench.tick();
        bench.position()[0] += fault.displaced;
        for (int tick = 0; tick < fault.patience; ++tick) {
            last = bench.tick(fault.input);
            CHECK(bench.loop().state() == LoopState::running);
        }
        double step = 0;
        for (int tick = 0; tick < 250; ++tick) {
            const double next = bench.tick(fault.input);
            step = std::max(step, std::abs(next - last));
            last = next;
        }
        CHECK(bench.loop().state() == LoopState::stopped);
        CHECK(bench.loop().cause() == fault.cause);
        CHECK(step <= largest_step + 1e-9);
        CHECK(last == Approx(weight(bench.position()[0])).margin(1e-3));
    }
}

} // namespace control_loop_stop_test
