// SPDX-License-Identifier: Apache-2.0
// A loop whose devices' frames are lost, late or wrongly stamped, and its behaviour when it stops.
#include "tests/tools/control/faulty_loop.hpp"

#include "dfdyn/hal/device/icub_two_joint_board.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tests/tools/simulation/faults/read_faults.hpp"
#include "tools/commands/options/robot_options.hpp"
#include "tools/control/closed_loop.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace faulty_loop_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
namespace hal = dfdyn::hal;

const std::string data = DFDYN_TEST_DATA_DIR;

/// Robot and scenario from the project's test data.
struct Arm {
    Robot robot;
    Scenario scenario;
};
Arm read_arm(const std::string& urdf, const std::string& scenario) {
    const std::string path = data + "/scenarios/" + scenario;
    Robot robot = read_scenario_robot(data + "/robots/" + urdf, path);
    Scenario read = read_scenario(path, robot);
    return {std::move(robot), std::move(read)};
}
Arm ur5() { return read_arm("ur5/ur5_robot.urdf", "ur5_loop.json"); }
Arm icub() { return read_arm("icub_right_arm/icub_right_arm.urdf", "icub_loop.json"); }
BusDescription bus_of(const std::string& name) { return read_bus_description(data + "/can/" + name); }

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

/// Buses of all device families for the small arm, with their boards and F/T sensor.
struct Family {
    std::string name, text;
};
std::vector<Family> families(const TemporaryDirectory& directory) {
    directory.write("joints.dbc", R"(VERSION ""
BU_: Arm Host
BO_ 288 Joints: 8 Arm
 SG_ First : 0|32@1- (0.000001,0) [-8|8] "rad" Host
 SG_ Second : 32|32@1- (0.000001,0) [-8|8] "rad" Host
BO_ 289 Efforts: 8 Arm
 SG_ FirstTorque : 0|32@1- (0.001,0) [-200|200] "Nm" Host
 SG_ SecondTorque : 32|32@1- (0.001,0) [-200|200] "Nm" Host
)");
    const auto bus = [](const std::string& trigger, const std::string& joints, const std::string& output) {
        return R"({"schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 500, "trigger": )" +
               trigger + R"(, "joints": {)" + joints + R"(}, "output": {)" + output + "}}";
    };
    return {
        {"cia402, efforts", bus(at_sync, R"("family": "cia402",
 "position": {"pdo": "0x280", "length": 6, "start_bit": 0, "bits": 32},
 "effort": {"pdo": "0x280", "length": 6, "start_bit": 32, "bits": 16},
 "boards": [{"node": 1, "joint": 1, "counts_per_turn": 1048576, "effort_per_count": 0.01},
            {"node": 2, "joint": 2, "counts_per_turn": 1048576, "effort_per_count": 0.01}])",
                                R"("family": "efforts", "quantity": "tau")")},
        {"odrive, ati_netcan",
         bus(R"({"on": "timer", "delay_s": 0.002})",
             R"("family": "odrive", "boards": [{"node": 1, "joint": 1, "motor_per_joint": 9},
                                               {"node": 2, "joint": 2, "motor_per_joint": -9}])",
             R"("family": "ati_netcan", "base": 32, "counts_per_newton": 100, "counts_per_newton_metre": 5000,
 "limit": [200, 200, 200, 6, 6, 6],
 "matrix": [1,0,0,0,0,0, 0,1,0,0,0,0, 0,0,1,0,0,0, 0,0,0,1,0,0, 0,0,0,0,1,0, 0,0,0,0,0,1])")},
        {"icub_two_joint_board, icub_strain",
         bus(at_set, R"("family": "icub_two_joint_board",
 "boards": [{"address": 1, "joints": [1, 2], "ticks_per_degree": [182.04, 182.04]}])",
             R"("family": "icub_strain", "address": 13, "full_scale": [1500, 1500, 2000, 35, 35, 25])")},
        {"icub_2foc, robotous_rft",
         bus(at_set,
             R"("family": "icub_2foc", "boards": [{"address": 1, "joint": 1}, {"address": 2, "joint": 2}])",
             R"("family": "robotous_rft")")},
        {"dbc, efforts", bus(at_set, R"("family": "dbc", "file": "joints.dbc", "boards": [
 {"joint": 1, "position": {"message": "Joints", "signal": "First"}, "effort": {"message": "Efforts", "signal": "FirstTorque"}},
 {"joint": 2, "position": {"message": "Joints", "signal": "Second"}, "effort": {"message": "Efforts", "signal": "SecondTorque"}}])",
                             R"("family": "efforts", "quantity": "tau")")},
    };
}

Arm small_arm() {
    Arm arm = read_arm("small_arm/small_arm.urdf", "small_arm_loop.json");
    arm.scenario.controller.rate_hz = 500;
    arm.scenario.force_torque.emplace();
    arm.scenario.force_torque->range = {100, 100, 100, 5, 5, 5};
    arm.scenario.force_torque->noise = {0.1, 0.1, 0.1, 0.01, 0.01, 0.01};
    return arm;
}

/// A cause that stops a loop, with the limits that the stop must keep.
struct StopFault {
    StopCause cause;
    int ticks;    ///< at most, from the fault to the stop, in addition to the delay of the bus
    double speed; ///< at most, after the fault, as a multiple of the speed before it
    /// At most, in addition to the distance at the speed before the fault until 0.1 s after the stop.
    double distance_rad;
    std::function<LoopFault(int after)> fault;
};

std::vector<StopFault> stop_faults() {
    const auto health = [](void (*spoil)(LoopInput&)) {
        return [spoil](int) {
            LoopFault fault;
            spoil(fault.given);
            return fault;
        };
    };
    const auto frozen = std::make_shared<JointVector>(); // the encoder's constant reading
    return {
        {StopCause::requested, 1, 1.2, 0, health([](LoopInput& input) { input.stop_requested = true; })},
        {StopCause::bus_lost, 1, 1.2, 0, health([](LoopInput& input) { input.bus_lost = true; })},
        {StopCause::missed_deadlines, 11, 1.2, 0,
         health([](LoopInput& input) { input.deadline_missed = true; })},
        {StopCause::no_position, 6, 1.2, 0,
         [](int) {
             LoopFault fault;
             fault.lost = true;
             return fault;
         }},
        // From the fault on the encoder is wrong by more than half a radian; the computed gravity is too.
        {StopCause::following_error, 1, 1.6, 0.2,
         [](int) {
             LoopFault fault;
             fault.reads = [](JointVector& position) { position[0] += 0.55; };
             return fault;
         }},
        {StopCause::frozen_encoder, 6, 1.2, 0,
         [frozen](int after) {
             LoopFault fault;
             fault.reads = [frozen, after](JointVector& position) {
                 if (after <= 0) {
                     *frozen = position;
                 }
                 position[0] = (*frozen)[0];
             };
             return fault;
         }},
    };
}

TEST_CASE("every stop over every device family is in time and without a jump and the arm comes to rest") {
    const TemporaryDirectory directory;
    const Arm arm = small_arm();
    for (const Family& family : families(directory)) {
        const BusDescription bus = read_bus_description(directory.write("bus.json", family.text));
        for (const StopFault& stop : stop_faults()) {
            CAPTURE(family.name, name(stop.cause));
            FaultyLoop loop(arm.robot, arm.scenario, bus);
            loop.run_to(1.6);
            REQUIRE(loop.loop().state() == LoopState::running);
            loop.forget_peaks();
            const double speed = loop.plant().truth().velocity.cwiseAbs().maxCoeff();
            const int begin = loop.moving_tick();
            int ticks = 0;
            loop.run_to(3.6, [&](int tick) {
                ticks += loop.loop().state() == LoopState::running ? 1 : 0;
                return stop.fault(tick - begin);
            });
            const int most = stop.ticks + loop.delay_ticks();
            CHECK(loop.loop().cause() == stop.cause);
            CHECK(ticks <= most);
            CHECK(loop.peak_step() < 0.1);
            CHECK(loop.peak_speed() < stop.speed * speed);
            CHECK(loop.peak_distance() < speed * (0.002 * most + 0.1) + stop.distance_rad);
            CHECK(loop.braked());
        }
    }
}

/// Returns the distance (rad) that a pendulum with an unmodelled load sinks after a stop, with or without a
/// model that learned the load before.
double sinks(const LoopModel* learned, const std::vector<double>& bandwidth) {
    Scenario scenario = pendulum_scenario();
    scenario.payloads = {{0, 1, Eigen::Vector3d::Zero()}};
    scenario.task = PointToPointTask{{JointVector::Constant(1, 0.3), JointVector::Constant(1, 0.7)}, 1, 0.5};
    FaultyLoop loop(test_pendulum(), scenario, one_drive(at_sync), learned,
                    {{0.5}, {}, StopMode::hold, bandwidth});
    loop.run_to(13.3); // during a dwell
    loop.forget_peaks();
    loop.run_to(15.5, [](int) {
        LoopFault fault;
        fault.given.bus_lost = true;
        return fault;
    });
    CHECK(loop.loop().cause() == StopCause::bus_lost);
    return loop.peak_distance();
}

TEST_CASE("an arm that has learned or observes its load holds it after the loop stops") {
    DFDYN_SEEDED_ENGINE(engine);
    const LoopModel model{unlearned_model(engine, 1, 0.008, {"tau1"}, 30), "model", true};
    const double nominal = sinks(nullptr, {0});
    CHECK(nominal > 0.02);
    CHECK(sinks(&model, {0}) < nominal / 3);
    CHECK(sinks(nullptr, {}) < nominal / 3);
}

TEST_CASE("a minute without faults causes no stop of the loop and no coasting tick", "[.long]") {
    for (const auto& [arm, bus] : {std::pair{ur5(), "ur5_loop.json"}, std::pair{icub(), "icub_loop.json"}}) {
        FaultyLoop loop(arm.robot, arm.scenario, bus_of(bus));
        loop.run_to(95);
        CHECK(loop.loop().state() == LoopState::running);
        CHECK(loop.loop().counters().coasted == 0);
    }
}

} // namespace faulty_loop_test
