// SPDX-License-Identifier: Apache-2.0
// Stops of a loop, over the devices of every family.
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tests/tools/control/test_arms.hpp"
#include "tools/can/families/family_catalogue.hpp"
#include "tools/control/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace faulty_loop_test {

/// Buses of all device families for the small arm, with their boards and F/T sensor.
struct Family {
    std::string name, text;
    /// Positions in steps of 0.2 to 0.4 mrad. A frozen reading is then a reading or two later beyond doubt.
    bool coarse = false;
};
constexpr const char* joints_dbc = R"(VERSION ""
BU_: Arm Host
BO_ 288 Joints: 8 Arm
 SG_ First : 0|32@1- (0.000001,0) [-8|8] "rad" Host
 SG_ Second : 32|32@1- (0.000001,0) [-8|8] "rad" Host
BO_ 289 Efforts: 8 Arm
 SG_ FirstTorque : 0|32@1- (0.001,0) [-200|200] "Nm" Host
 SG_ SecondTorque : 32|32@1- (0.001,0) [-200|200] "Nm" Host
)";
std::vector<Family> families(const TemporaryDirectory& directory) {
    directory.write("joints.dbc", joints_dbc);
    const auto bus = [](const std::string& trigger, const std::string& joints, const std::string& output) {
        return R"({"schema": "dfdyn.bus/1", "bit_rate": 1000000, "data_bit_rate": 5000000,
 "sample_rate_hz": 500, "trigger": )" +
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
        {"damiao, efforts",
         bus(at_set, R"("family": "damiao", "boards": [
 {"motor_id": 1, "feedback_id": "0x11", "joint": 1, "position_max": 12.5, "velocity_max": 20, "torque_max": 100},
 {"motor_id": 2, "feedback_id": "0x12", "joint": 2, "position_max": 12.5, "velocity_max": 20, "torque_max": 50}])",
             R"("family": "efforts", "quantity": "tau")"),
         true},
        {"robstride, efforts",
         bus(at_set, R"("family": "robstride", "boards": [{"motor_id": 1, "joint": 1, "motor": "RS03"},
                                                          {"motor_id": 2, "joint": 2, "motor": "RS03"}])",
             R"("family": "efforts", "quantity": "tau")"),
         true},
        {"cubemars, efforts",
         bus(at_set, R"("family": "cubemars", "boards": [{"motor_id": 1, "joint": 1, "motor": "AK80-9"},
                                                         {"motor_id": 2, "joint": 2, "motor": "AK80-9"}])",
             R"("family": "efforts", "quantity": "tau")"),
         true},
        {"rmd, efforts",
         bus(at_set, R"("family": "rmd", "boards": [
 {"motor_id": 1, "joint": 1, "newton_metre_per_ampere": 2.1},
 {"motor_id": 2, "joint": 2, "newton_metre_per_ampere": 2.1}])",
             R"("family": "efforts", "quantity": "tau")"),
         true},
        {"moteus, efforts",
         bus(at_set, R"("family": "moteus", "boards": [{"id": 1, "joint": 1}, {"id": 2, "joint": 2}])",
             R"("family": "efforts", "quantity": "tau")")},
    };
}

/// Families whose joints take torque commands.
std::set<std::string> driven_families() {
    std::set<std::string> names;
    for (const JointFamily& family : joint_families()) {
        names.emplace(family.name);
    }
    names.erase("piper"); // its arms take positions
    return names;
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

/// Returns the scenario with an encoder of joint 1 that reads 0.6 rad too much from 4 s on.
Scenario with_jump(Scenario scenario, double lasts_s) {
    Fault fault;
    fault.from_ns = 4'000'000'000;
    fault.until_ns = fault.from_ns + std::llround(1e9 * lasts_s);
    fault.act = [](Faults& faults) { faults.encoders.jump[0] += 0.6; };
    scenario.faults = {fault};
    return scenario;
}

TEST_CASE("every stop over every device family is in time and without a jump and the arm comes to rest") {
    const TemporaryDirectory directory;
    const Arm arm = small_arm();
    std::set<std::string> tested;
    for (const Family& family : families(directory)) {
        tested.insert(family.name.substr(0, family.name.find(',')));
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
            const bool later = family.coarse && stop.cause == StopCause::frozen_encoder;
            const int most = stop.ticks + loop.delay_ticks() + (later ? 2 : 0);
            const double distance_rad = stop.distance_rad + (later ? 0.04 : 0);
            CHECK(loop.loop().cause() == stop.cause);
            CHECK(ticks <= most);
            CHECK(loop.peak_step() < 0.1);
            CHECK(loop.peak_speed() < stop.speed * speed);
            CHECK(loop.peak_distance() < speed * (0.002 * most + 0.1) + distance_rad);
            CHECK(loop.braked());
        }
    }
    CHECK(tested == driven_families());
}

TEST_CASE("one wrong position over any device family stops the arm where it is or is ignored") {
    const TemporaryDirectory directory;
    const Arm arm = small_arm();
    for (const Family& family : families(directory)) {
        for (const double jump : {-0.6, 0.2, 0.6}) {
            CAPTURE(family.name, jump);
            FaultyLoop loop(arm.robot, arm.scenario,
                            read_bus_description(directory.write("bus.json", family.text)));
            loop.run_to(1.6);
            loop.forget_peaks();
            const double speed = loop.plant().truth().velocity.cwiseAbs().maxCoeff();
            const int begin = loop.moving_tick();
            loop.run_to(2.2, [&](int tick) {
                LoopFault fault;
                if (tick == begin + 1) {
                    fault.reads = [jump](JointVector& position) { position[0] += jump; };
                }
                return fault;
            });
            CHECK(loop.peak_step() <= 0.1 + 1e-9);
            if (loop.loop().state() != LoopState::running) {
                CHECK(loop.loop().cause() == StopCause::following_error);
                CHECK(loop.braked());
                CHECK(loop.peak_speed() < 1.2 * speed);
                CHECK(loop.peak_distance() < speed * 0.14);
            }
        }
    }
}

TEST_CASE("one wrong position does not make the stop of a loop at 100 Hz throw the arm") {
    Arm arm = read_arm("small_arm/small_arm.urdf", "small_arm_loop.json");
    for (const double lasts_s : {0.01, 10.0}) {
        CAPTURE(lasts_s);
        ClosedLoop loop(arm.robot, with_jump(arm.scenario, lasts_s), "test", nullptr, nullptr, {});
        loop.run_to(3.99, [](const ClosedLoopInstant&) {});
        const double speed = loop.plant().truth().velocity.cwiseAbs().maxCoeff();
        double peak = 0;
        loop.run_to(6, [&](const ClosedLoopInstant&) {
            peak = std::max(peak, loop.plant().truth().velocity.cwiseAbs().maxCoeff());
        });
        CHECK(loop.loop().cause() == StopCause::following_error);
        CHECK(peak < 2 * speed);
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

TEST_CASE("a stop does not keep the friction of the motion that the observer compensated") {
    Scenario scenario = pendulum_scenario();
    scenario.controller.position_gain[0] = 5;
    scenario.controller.velocity_gain[0] = 1;
    scenario.actuators.friction.assign(1, {});
    scenario.actuators.friction[0].viscous = 3; // the position gain alone balances it after 0.6 s
    scenario.task = PointToPointTask{{JointVector::Constant(1, 0.3), JointVector::Constant(1, 1.5)}, 3, 0.5};
    FaultyLoop loop(test_pendulum(), scenario, one_drive(at_sync), nullptr,
                    {{0.5}, {}, StopMode::hold, {40}});
    loop.run_to(1.5); // at the largest speed
    REQUIRE(loop.loop().state() == LoopState::running);
    REQUIRE(loop.plant().truth().velocity[0] > 0.5);
    loop.forget_peaks();
    loop.run_to(2.5, [](int) {
        LoopFault fault;
        fault.given.bus_lost = true;
        return fault;
    });
    CHECK(loop.loop().state() == LoopState::stopped);
    CHECK(loop.peak_distance() < 0.12); // braking alone takes 0.03 rad
    CHECK(loop.braked());
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
