// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/control_loop.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/control/loop/loop_bench.hpp"
#include "tools/base/text/error.hpp"
#include "tools/control/loop_setup.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace control_loop_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Catch::Matchers::Contains;
using Bench = LoopBench;

TEST_CASE("no command exceeds the torque limit and commands at the limit are counted") {
    Scenario scenario = pendulum_scenario();
    scenario.actuators.torque_limit = JointVector::Constant(1, 1);
    Bench bench(scenario, {{0.5}, {}, StopMode::hold});
    bench.tick();
    for (int tick = 0; tick < 20; ++tick) {
        bench.position()[0] -= 0.01; // up to 10 N·m of feedback
        bench.tick();
    }
    CHECK(bench.tick() == 1);
    double last = 1;
    for (int tick = 0; tick < 90; ++tick) {
        bench.position()[0] += tick < 40 ? 0.01 : 1e-5 * (tick % 2 == 0 ? 1 : -1);
        const double torque = bench.tick();
        CHECK(std::abs(torque) <= 1);
        last = torque;
    }
    CHECK(last == -1);
    CHECK(bench.loop().counters().limited >= 20);
}

TEST_CASE("an arm beside its start is led in slowly from where it is, and then the motion begins") {
    Bench bench(pendulum_scenario());
    const double start = bench.position()[0];
    bench.position()[0] -= 0.1; // 5 N·m of feedback
    const double weight_there = weight(bench.position()[0]);
    CHECK(bench.tick() == Approx(weight_there).margin(0.01));
    CHECK(bench.loop().start_offset()[0] == Approx(-0.1));
    const auto& reference = [&]() -> const Reference& { return bench.loop().reference(); };
    double before = reference().position[0];
    CHECK(before == Approx(start - 0.1));
    for (int tick = 1; tick < 750; ++tick) { // 1.875 · 0.1 rad / 0.25 rad/s
        bench.position() = reference().position;
        bench.tick();
        const double step = reference().position[0] - before;
        CHECK(step >= -1e-12);
        CHECK(step <= PausableTask::lead_in_speed * 0.001 + 1e-12);
        CHECK(reference().velocity[0] == Approx(step / 0.001).margin(1e-3));
        before = reference().position[0];
    }
    CHECK(before == Approx(start).margin(1e-6));
    for (int tick = 0; tick < 1000; ++tick) {
        bench.position() = reference().position;
        bench.tick();
    }
    CHECK(std::abs(reference().position[0] - start) > 0.01);
    CHECK(bench.loop().state() == LoopState::running);
}

TEST_CASE("an arm that the position gain holds with a twentieth of the limit is not led in") {
    Bench bench(pendulum_scenario());
    bench.position()[0] -= 0.019; // 0.95 of 20 N·m
    bench.tick();
    CHECK(bench.loop().start_offset()[0] == 0);
    CHECK(bench.loop().lead_in_s() == 0);
}

TEST_CASE("the loop applies no torque to an arm that is away from the start of the motion") {
    Bench bench(pendulum_scenario());
    bench.position()[0] += 1;
    for (int tick = 0; tick < 10; ++tick) {
        CHECK(bench.tick() == 0);
    }
    CHECK(bench.loop().cause() == StopCause::following_error);
    CHECK(bench.loop().counters().running == 0);
}

TEST_CASE("a sample found by a late tick serves its own tick, without the joints that it lacks") {
    for (const bool lacks : {false, true}) {
        CAPTURE(lacks);
        Bench bench(pendulum_scenario());
        for (int tick = 0; tick < 50; ++tick) {
            bench.tick();
        }
        const std::vector<bool> missing{lacks};
        bench.late_tick(1, &missing);
        bench.late_tick(1, nullptr); // finds the next one, too
        CHECK(bench.loop().counters().coasted == (lacks ? 2 : 1));
        bench.tick(false); // has the second one
        CHECK(bench.loop().counters().coasted == (lacks ? 2 : 1));
        bench.tick();
        CHECK(bench.loop().counters().coasted == (lacks ? 2 : 1));
    }
}

TEST_CASE("samples that stay a tick old are learned") {
    DFDYN_SEEDED_ENGINE(engine);
    Scenario scenario = pendulum_scenario();
    const LoopModel model{unlearned_model(engine, 1, 0.008, {"tau1"}, 40), "model", true};
    const auto loop = make_control_loop(test_pendulum(), scenario, "test", &model, 0, no_observer);
    JointVector before = loop->reference().position;
    const auto tick = [&](std::int64_t number, bool valid) {
        LoopInput input;
        input.time_ns = 1'000'000 * number;
        input.position = valid ? &before : nullptr;
        const JointVector present = loop->reference().position;
        loop->tick(input);
        before = present;
    };
    for (int number = 0; number < 400; ++number) {
        tick(number, true);
    }
    const std::uint64_t learned = loop->feed_forward().learned()->counters().learned;
    REQUIRE(learned > 0);
    tick(400, false);
    for (int number = 401; number < 1000; ++number) {
        tick(number - 1, true);
    }
    CHECK(loop->state() == LoopState::running);
    CHECK(loop->feed_forward().learned()->counters().learned > learned + 50); // of 75 knots
}

TEST_CASE("a motion that leaves the joint's limits is rejected before the loop moves") {
    Robot robot = test_pendulum();
    Scenario scenario = pendulum_scenario();
    PointToPointTask task{{JointVector::Zero(1), JointVector::Constant(1, 1)}, 1, 0.5};
    scenario.task = task;
    robot.joints[0].lower = -1;
    robot.joints[0].upper = 0.9;
    CHECK_THROWS_WITH(make_control_loop(robot, scenario, "s.json", nullptr),
                      Contains("s.json: task: reference of joint ") &&
                          Contains("expected a position within its limits"));
    robot.joints[0].upper = 1.1;
    CHECK_NOTHROW(make_control_loop(robot, scenario, "s.json", nullptr));
}

TEST_CASE("default limits follow from gains and torque limits and robot unless limits are given") {
    Scenario scenario = pendulum_scenario();
    Robot robot = test_pendulum();
    robot.joints[0].velocity = 2.5;
    const auto limits = [&](double gain) {
        scenario.controller.position_gain[0] = gain;
        return default_limits(robot, scenario, *scenario.actuators.torque_limit, JointVector::Zero(1));
    };
    CHECK(limits(100).following_error[0] == Approx(0.8 * 20 / 100));
    CHECK(limits(10).following_error[0] == 0.5);
    CHECK(limits(0).following_error[0] == 0.5);
    CHECK(limits(100).sticking[0] == Approx(0.25 * 20 / 100));
    CHECK(std::isinf(limits(0).sticking[0]));
    CHECK(limits(100).speed_limit[0] == 2.5);
    CHECK(limits(100).acceleration[0] ==
          Approx(2 * 20 / (pendulum_mass * pendulum_length * pendulum_length)));
    robot.joints[0].prismatic = true;
    CHECK(limits(10).following_error[0] == 0.1);
    robot.joints[0].velocity = 50000;
    CHECK(std::isinf(limits(10).speed_limit[0]));
    const auto make = [](const LoopLimits& given) {
        return make_control_loop(test_pendulum(), pendulum_scenario(), "test", nullptr, 0, given);
    };
    CHECK_THROWS_WITH(make({{0.1, 0.2}, {}, StopMode::hold}),
                      "--following-error: expected 1 value, or one for each of 1 joints, found 2");
    Bench bench(pendulum_scenario(), {{0.01}, {}, StopMode::hold});
    bench.position()[0] += 0.02;
    bench.tick();
    CHECK(bench.loop().cause() == StopCause::following_error);
}

TEST_CASE("a scenario or model that the loop cannot use is rejected with the expected value") {
    const auto refusal = [](const Scenario& scenario, const Robot& robot, const LoopModel* model) {
        try {
            make_control_loop(robot, scenario, "s.json", model);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("none");
    };
    Scenario scenario = pendulum_scenario();
    CHECK(refusal(scenario, test_pendulum(), nullptr) == "none");
    LoopModel model{{}, "m.json", false};
    model.model.joints = 2;
    model.model.outputs.names = {"tau1", "tau2"};
    CHECK(refusal(scenario, test_pendulum(), &model) ==
          "m.json: expected a model of the outputs tau1, found one of tau1, tau2");
    model.model.joints = 1;
    model.model.outputs.names = {"tau1"};
    model.model.sample_period_s = 0.0085;
    CHECK(refusal(scenario, test_pendulum(), &model) ==
          "m.json: expected a sample period that is a multiple of the loop's 0.001 s, found 0.0085 s");
    scenario.actuators.torque_limit.reset();
    CHECK(refusal(scenario, test_pendulum(), nullptr) ==
          "s.json: actuators.torque_limit_nm: expected a limit of joint swing, for which the robot has none, "
          "found none");
    Robot robot = test_pendulum();
    robot.joints[0].effort = 20;
    CHECK(refusal(scenario, robot, nullptr) == "none");
    scenario.controller.kind = ControllerKind::computed_torque;
    CHECK(refusal(scenario, robot, nullptr) ==
          "s.json: controller.kind: expected feed_forward, found computed_torque");
}

TEST_CASE("a position that is NaN moves nothing and the loop continues") {
    Bench bench(pendulum_scenario());
    for (int tick = 0; tick < 50; ++tick) {
        bench.tick();
    }
    const double before = bench.tick();
    const double position = bench.position()[0];
    bench.position()[0] = std::numeric_limits<double>::quiet_NaN();
    const double during = bench.tick();
    CHECK(std::isfinite(during));
    CHECK(std::abs(during) <= std::abs(before) + 1);
    bench.position()[0] = position;
    for (int tick = 0; tick < 50; ++tick) {
        CHECK(std::abs(bench.tick()) <= 20);
    }
    CHECK(std::abs(bench.tick() - before) < 1);
}

} // namespace control_loop_test
