// SPDX-License-Identifier: Apache-2.0
// A loop whose devices' frames are lost, late or wrongly stamped.
#include "dfdyn/hal/device/icub_two_joint_board.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tests/tools/control/test_arms.hpp"
#include "tests/tools/simulation/faults/read_faults.hpp"
#include "tools/control/closed_loop.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace faulty_loop_test {

constexpr std::int64_t ms = 1'000'000;

/// A fault in time. `fault` receives the number of ticks since it began, at least 0.
struct TimeFault {
    std::string name;
    std::function<LoopFault(int after)> fault;
};

std::vector<TimeFault> time_faults() {
    std::vector<TimeFault> faults;
    for (const int ticks : {1, 2, 3}) {
        faults.push_back({std::to_string(ticks) + " cycles lost", [ticks](int after) {
                              LoopFault fault;
                              fault.lost = after < ticks;
                              return fault;
                          }});
    }
    faults.push_back({"a late tick", [](int after) {
                          LoopFault fault;
                          fault.late_ticks = after < 1 ? 1 : 0;
                          return fault;
                      }});
    for (const std::int64_t jump_ns : {4 * ms, -4 * ms, 20 * ms, -20 * ms, 1000 * ms, -1000 * ms}) {
        faults.push_back({"clock jumps by " + std::to_string(jump_ns / ms) + " ms", [jump_ns](int) {
                              LoopFault fault;
                              fault.clock_ns = jump_ns;
                              return fault;
                          }});
    }
    return faults;
}

TEST_CASE("lost cycles and late ticks and clock jumps change no command by a tenth of its limit") {
    const auto [arm, bus] =
        GENERATE(table<std::string, std::string>({{"ur5", "ur5_loop.json"}, {"icub", "icub_loop.json"}}));
    const Arm parts = arm == "ur5" ? ur5() : icub();
    const double begin_s = 3.4;
    const auto run = [&, &name = bus](const std::function<LoopFault(int)>& fault) {
        auto loop = std::make_unique<FaultyLoop>(parts.robot, parts.scenario, bus_of(name));
        loop->run_to(begin_s);
        loop->forget_peaks();
        const int begin = loop->moving_tick();
        loop->run_to(begin_s + 0.3, [&](int tick) { return fault(tick - begin); });
        return loop;
    };
    const auto healthy = run([](int) { return LoopFault(); });
    REQUIRE(healthy->peak_step() < 0.05);
    for (const TimeFault& fault : time_faults()) {
        CAPTURE(arm, fault.name);
        const auto loop = run(fault.fault);
        CHECK(loop->peak_step() < 0.1);
        CHECK(loop->peak_speed() < 1.2 * healthy->peak_speed());
        CHECK(loop->loop().state() == LoopState::running);
    }
}

TEST_CASE(
    "losing 1 % or 5 % of the frames changes no command by a tenth of its limit and the loop keeps running") {
    DFDYN_SEEDED_ENGINE(engine);
    const Arm parts = ur5();
    for (const double share : {0.01, 0.05}) {
        CAPTURE(share);
        FaultyLoop loop(parts.robot, parts.scenario, bus_of("ur5_loop.json"));
        loop.run_to(0.2);
        loop.forget_peaks();
        loop.run_to(8, [&](int) {
            LoopFault fault;
            fault.drops = [&](const hal::Frame&) {
                return std::uniform_real_distribution<double>(0, 1)(engine) < share;
            };
            return fault;
        });
        CHECK(static_cast<double>(loop.loop().counters().coasted) > 3000 * share);
        CHECK(loop.peak_step() < 0.1);
        CHECK(loop.loop().state() == LoopState::running);
    }
}

/// Returns whether a device of the iCub's bus sends this frame with joint positions.
bool has_positions(const hal::Frame& frame) {
    const hal::icub::TwoJointBoard first(1, {0}, {1}), second(2, {2}, {3});
    return first.claims(frame.id) || second.claims(frame.id);
}

TEST_CASE("a lost frame of the F/T sensor costs no reading of a joint") {
    const Arm parts = icub();
    for (const int lost : {0, 1}) {
        FaultyLoop loop(parts.robot, parts.scenario, bus_of("icub_loop.json"));
        loop.run_to(0.2);
        const int begin = loop.moving_tick();
        const std::uint64_t invalid = loop.port().invalid;
        loop.run_to(0.3, [&](int tick) {
            LoopFault fault;
            fault.drops = [&, part = 0, tick](const hal::Frame& frame) mutable {
                return tick == begin && !has_positions(frame) && part++ == lost;
            };
            return fault;
        });
        CAPTURE(lost);
        CHECK(loop.loop().counters().coasted == 0);
        CHECK(loop.port().invalid == invalid);
    }
}

TEST_CASE("the iCub's loop coasts only in ticks that lost positions") {
    DFDYN_SEEDED_ENGINE(engine);
    const Arm parts = icub();
    for (const double share : {0.01, 0.05}) {
        CAPTURE(share);
        FaultyLoop loop(parts.robot, parts.scenario, bus_of("icub_loop.json"));
        loop.run_to(0.2);
        loop.forget_peaks();
        std::set<int> incomplete;
        loop.run_to(8, [&](int tick) {
            LoopFault fault;
            fault.drops = [&, tick](const hal::Frame& frame) {
                const bool drop = std::uniform_real_distribution<double>(0, 1)(engine) < share;
                if (drop && has_positions(frame)) {
                    incomplete.insert(tick);
                }
                return drop;
            };
            return fault;
        });
        CHECK(static_cast<double>(incomplete.size()) > 7000 * share);
        CHECK(loop.loop().counters().coasted <= incomplete.size());
        CHECK(loop.peak_step() < 0.1);
        CHECK(loop.loop().state() == LoopState::running);
    }
}

TEST_CASE("setting the common clock of ticks and stamps leaves commands and errors almost unchanged") {
    const auto [arm, bus] =
        GENERATE(table<std::string, std::string>({{"ur5", "ur5_loop.json"}, {"icub", "icub_loop.json"}}));
    Arm parts = arm == "ur5" ? ur5() : icub();
    const BusDescription description = bus_of(bus);
    const auto peaks = [&](double by_s) {
        parts.scenario.faults.clear();
        if (by_s != 0) {
            parts.scenario.faults =
                faults_of(R"([{"kind": "clock_jump", "clock": "bus", "at_s": 3.4, "by_s": )" +
                              std::to_string(by_s) + "}]",
                          static_cast<int>(parts.robot.joints.size()));
        }
        ClosedLoop loop(parts.robot, parts.scenario, "test", nullptr, &description);
        JointVector before;
        double step = 0, error = 0;
        loop.run_to(4, [&](const ClosedLoopInstant& instant) {
            if (before.size() > 0 && instant.time_s > 3.3) {
                const JointVector change = instant.command - before;
                step = std::max(
                    step, change.cwiseQuotient(*parts.scenario.actuators.torque_limit).cwiseAbs().maxCoeff());
                error = std::max(error, instant.error.cwiseAbs().maxCoeff());
            }
            before = instant.command;
        });
        CHECK(loop.loop().state() == LoopState::running);
        return std::pair(step, error);
    };
    const auto [usual_step, usual_error] = peaks(0);
    for (const double by_s : {-1.0, -0.1, -0.004, 0.004, 0.1, 1.0}) {
        CAPTURE(arm, by_s);
        const auto [step, error] = peaks(by_s);
        CHECK(step < 1.5 * usual_step);
        CHECK(error < 1.1 * usual_error);
    }
}

} // namespace faulty_loop_test
