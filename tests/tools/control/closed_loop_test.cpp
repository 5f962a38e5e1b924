// SPDX-License-Identifier: Apache-2.0
// The loop and the simulated arm, connected directly or by the frames of devices, in simulated time.
#include "tools/control/closed_loop.hpp"

#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tests/tools/control/pendulum.hpp"
#include "tools/base/text/error.hpp"
#include "tools/control/report/tracking.hpp"

#include <cmath>
#include <vector>

namespace closed_loop_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

LoopLimits without_observer() {
    LoopLimits limits;
    limits.observer_bandwidth = {0};
    return limits;
}

/// Tracking errors of the pendulum at each tick, rad.
std::vector<double> errors(const Scenario& scenario, double duration_s, const LoopModel* model = nullptr,
                           const BusDescription* bus = nullptr,
                           const LoopLimits& limits = without_observer()) {
    ClosedLoop loop(test_pendulum(), scenario, "test", model, bus, limits);
    std::vector<double> result;
    loop.run_to(duration_s, [&](const ClosedLoopInstant& instant) { result.push_back(instant.error[0]); });
    CHECK(loop.loop().state() == LoopState::running);
    return result;
}

double rms(const std::vector<double>& values, std::size_t first) {
    double square = 0;
    for (std::size_t i = first; i < values.size(); ++i) {
        square += values[i] * values[i];
    }
    return std::sqrt(square / static_cast<double>(values.size() - first));
}

Scenario loaded_scenario() {
    Scenario scenario = pendulum_scenario();
    scenario.payloads = {{0, 0.5, Eigen::Vector3d::Zero()}};
    return scenario;
}

LoopModel random_model(std::mt19937_64& engine) {
    return {unlearned_model(engine, 1, 0.008, {"tau1"}, 30), "model", true};
}

TEST_CASE("an exact rigid body makes the loop follow and an unknown payload leaves the error of its weight") {
    CHECK(rms(errors(pendulum_scenario(), 5), 0) < 1e-3);
    Scenario scenario = pendulum_scenario();
    scenario.payloads = {{0, 0.2, Eigen::Vector3d::Zero()}};
    // About 0.3 rad: the weight of 0.2 kg over the position gain.
    const double sag = 0.2 / pendulum_mass * weight(0.3) / 50;
    CHECK(rms(errors(scenario, 5), 0) == Approx(sag).epsilon(0.5));
}

TEST_CASE("an arm that starts beside the motion is led in without a kick") {
    Scenario scenario = pendulum_scenario();
    scenario.start_offset = JointVector::Constant(1, 0.25); // 12.5 of 20 N·m of feedback
    ClosedLoop loop(test_pendulum(), scenario, "test", nullptr, nullptr, without_observer());
    double before = 0;
    int tick = 0;
    loop.run_to(5, [&](const ClosedLoopInstant& instant) {
        const double command = instant.command[0];
        if (tick == 0) {
            CHECK(command == Approx(weight(loop.plant().truth().position[0])).margin(0.05));
        } else {
            CHECK(std::abs(command - before) < 0.5);
        }
        CHECK(std::abs(instant.error[0]) < 2e-3);
        before = command;
        ++tick;
    });
    CHECK(loop.loop().state() == LoopState::running);
    CHECK(loop.loop().start_offset()[0] == Approx(0.25));
}

TEST_CASE("a loop that learns compensates an unknown payload") {
    DFDYN_SEEDED_ENGINE(engine);
    const LoopModel model = random_model(engine);
    const std::vector<double> nominal = errors(loaded_scenario(), 12);
    const std::vector<double> learned = errors(loaded_scenario(), 12, &model);
    CHECK(rms(learned, 8000) < rms(nominal, 8000) / 3);
}

TEST_CASE(
    "an observer compensates an unknown payload within a second and learning reduces the error further") {
    DFDYN_SEEDED_ENGINE(engine);
    const LoopModel model = random_model(engine);
    const double nominal = rms(errors(loaded_scenario(), 12), 1000);
    const std::vector<double> observed = errors(loaded_scenario(), 12, nullptr, nullptr, {});
    const std::vector<double> learned = errors(loaded_scenario(), 12, &model, nullptr, {});
    CHECK(rms(observed, 1000) < nominal / 10);
    CHECK(rms(learned, 8000) < rms(observed, 8000));
}

TEST_CASE("with a learned limit of zero the loop moves as without learning but still learns") {
    DFDYN_SEEDED_ENGINE(engine);
    const LoopModel model = random_model(engine);
    LoopLimits limits = without_observer();
    limits.learned_limit = {0};
    ClosedLoop loop(test_pendulum(), loaded_scenario(), "test", &model, nullptr, limits);
    std::vector<double> shadowed;
    loop.run_to(5, [&](const ClosedLoopInstant& instant) { shadowed.push_back(instant.error[0]); });
    CHECK(shadowed == errors(loaded_scenario(), 5));
    CHECK(loop.loop().feed_forward().learned_share()[0] > 0.5);
}

TEST_CASE("the learned torque is disabled and enabled in a running loop without a step") {
    DFDYN_SEEDED_ENGINE(engine);
    const LoopModel model = random_model(engine);
    ClosedLoop loop(test_pendulum(), loaded_scenario(), "test", &model, nullptr, without_observer());
    double command = 0, step = 0;
    const auto run_to = [&](double time_s) {
        loop.run_to(time_s, [&](const ClosedLoopInstant& instant) {
            step = std::max(step, std::abs(instant.command[0] - command));
            command = instant.command[0];
        });
        return loop.loop().feed_forward().learned_share()[0];
    };
    CHECK(run_to(8) > 0.9);
    step = 0;
    CHECK(run_to(9) > 0.9);
    const double usual = step;
    loop.enable_learned(false);
    CHECK(run_to(9.3) == 0);
    loop.enable_learned(true);
    CHECK(run_to(10) > 0.9);
    CHECK(step < usual + 0.4); // N·m, of 20
}

TEST_CASE(
    "frames between loop and arm add no more than their quantisation to the error and SYNC one period") {
    const double direct = rms(errors(loaded_scenario(), 4), 0);
    const BusDescription by_sync = one_drive(at_sync);
    const BusDescription by_set = one_drive(at_set);
    CHECK(rms(errors(loaded_scenario(), 4, nullptr, &by_set), 0) == Approx(direct).epsilon(0.01));
    CHECK(rms(errors(loaded_scenario(), 4, nullptr, &by_sync), 0) == Approx(direct).epsilon(0.05));
}

TEST_CASE("the same closed loop gives bit-identical errors over frames and with learning") {
    DFDYN_SEEDED_ENGINE(engine);
    const LoopModel model = random_model(engine);
    const BusDescription bus = one_drive(at_sync);
    Scenario scenario = loaded_scenario();
    scenario.encoders.noise = 1e-4;
    const std::vector<double> once = errors(scenario, 2, &model, &bus);
    CHECK(once == errors(scenario, 2, &model, &bus));
    scenario.seed = 2;
    CHECK(once != errors(scenario, 2, &model, &bus));
}

// At a sample, the host's estimators allocate their results because their sizes are known only at run time.
TEST_CASE("a loop that learns does not allocate memory between two samples of its model") {
    DFDYN_SEEDED_ENGINE(engine);
    const LoopModel model = random_model(engine);
    const auto loop = make_control_loop(test_pendulum(), pendulum_scenario(), "test", &model);
    JointVector position = loop->reference().position;
    JointVector torque = JointVector::Zero(1);
    std::uint64_t between = 0, at_samples = 0;
    for (int tick = 0; tick < 2000; ++tick) {
        position[0] += 1e-4 * std::sin(0.01 * tick);
        LoopInput input;
        input.time_ns = std::int64_t{1'000'000} * tick;
        input.position = &position;
        input.torque = &torque;
        const AllocationGuard guard;
        torque = loop->tick(input);
        (tick % 8 == 0 ? at_samples : between) += guard.calls().allocations;
    }
    CHECK(between == 0);
    CHECK(at_samples <= 250 * 6 + 20);
    CHECK(loop->state() == LoopState::running);
    CHECK(loop->feed_forward().learned()->counters().learned > 200);
}

TEST_CASE("a bus that does not fit robot and scenario is rejected") {
    const auto refusal = [](const BusDescription& bus, const Scenario& scenario, const Robot& robot) {
        try {
            check_bus(bus, robot, scenario);
        } catch (const InputError& error) {
            const std::string text = error.what();
            return text.substr(text.find("bus.json: ") + 10);
        }
        return std::string("none");
    };
    Scenario scenario = pendulum_scenario();
    const Robot robot = test_pendulum();
    CHECK(refusal(one_drive(at_sync), scenario, robot) == "none");
    CHECK(refusal(one_drive(at_sync, "i"), scenario, robot) ==
          "output.quantity: expected tau, with effort_per_count in N·m, because the torque command of these "
          "drives has the unit of their efforts, found i");
    Robot longer = robot;
    longer.joints.push_back(robot.joints[0]);
    CHECK(refusal(one_drive(at_sync), scenario, longer) == "joints: expected the robot's 2 joints, found 1");
    BusDescription slow = one_drive(at_sync);
    slow.bit_rate = 200'000; // SYNC, 6 bytes and 2 bytes at 1 kHz: 55 + 115 + 75 bits
    CHECK(refusal(slow, scenario, robot) ==
          "bit_rate: expected a bus that carries its devices' frames and their commands, found one that they "
          "load to 123 %");
    scenario.controller.rate_hz = 500;
    CHECK(refusal(one_drive(at_sync), scenario, robot) ==
          "joints: expected the rate of the loop, 500 Hz, found 1000");
}

} // namespace closed_loop_test
