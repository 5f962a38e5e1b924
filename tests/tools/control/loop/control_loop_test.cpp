// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/control_loop.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/control/pendulum.hpp"
#include "tools/base/text/error.hpp"
#include "tools/control/loop_setup.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace control_loop_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

/// Without an observer, so that the torque that holds the arm is the nominal weight alone.
const LoopLimits no_observer{{}, {}, StopMode::hold, {0}};

/// A loop with a pendulum that rests at the start of the reference; the test runs it tick by tick.
class Bench {
  public:
    explicit Bench(const Scenario& scenario, const LoopLimits& limits = {})
        : loop_(make_control_loop(test_pendulum(), scenario, "test", nullptr, 0, limits)),
          position_(loop_->reference().position) {}

    double tick(bool valid = true, bool stop = false) {
        LoopInput input;
        input.stop_requested = stop;
        return tick(input, valid);
    }
    double tick(LoopInput input, bool valid = true) {
        input.time_ns = 1'000'000 * ticks_++;
        input.position = valid ? &position_ : nullptr;
        return loop_->tick(input)[0];
    }
    ControlLoop& loop() { return *loop_; }
    JointVector& position() { return position_; }

  private:
    std::unique_ptr<ControlLoop> loop_;
    JointVector position_;
    std::int64_t ticks_ = 0;
};

TEST_CASE("no command exceeds the torque limit and commands at the limit are counted") {
    Scenario scenario = pendulum_scenario();
    scenario.actuators.torque_limit = JointVector::Constant(1, 1);
    Bench bench(scenario, {{0.5}, {}, StopMode::hold});
    bench.position()[0] -= 0.2; // 10 N·m of feedback
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

TEST_CASE("the loop applies no torque to an arm that is away from the start of the motion") {
    Bench bench(pendulum_scenario());
    bench.position()[0] += 1;
    for (int tick = 0; tick < 10; ++tick) {
        CHECK(bench.tick() == 0);
    }
    CHECK(bench.loop().cause() == StopCause::following_error);
    CHECK(bench.loop().counters().running == 0);
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
    for (int tick = 0; tick < 50; ++tick) {
        bench.position()[0] += 0.001; // 1 rad/s
        torque = bench.tick(true, true);
    }
    const double spring = 50 * 0.05; // position gain times the distance to the rest position
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
            for (int tick = 0; tick < 1000; ++tick) {
                LoopInput input;
                input.bus_lost = tick == 0;
                torque = bench.tick(input, !blind);
                requested = requested < 0 && bench.loop().brake_requested() ? tick : requested;
                limp = limp < 0 && bench.loop().limp() ? tick : limp;
            }
            CHECK(requested == (blind ? 5 : 200)); // ticks without damping, or of the ramp
            CHECK(limp == (mode == StopMode::limp ? requested + 200 : -1));
            CHECK(torque == Approx(mode == StopMode::limp ? 0 : weight(bench.position()[0])).margin(0.01));
            CHECK(bench.loop().done() == (mode == StopMode::limp || blind));
        }
    }
}

TEST_CASE("the loop is done once brakes are requested after a requested stop or after a second of silence") {
    Bench told(pendulum_scenario()), silent(pendulum_scenario());
    for (int tick = 0; tick < 50; ++tick) {
        told.tick();
        silent.tick();
    }
    LoopInput lost;
    lost.bus_lost = true;
    for (int tick = 0; tick < 2000; ++tick) {
        told.tick(lost);
        CHECK_FALSE(told.loop().done());
        silent.tick(false);
        CHECK(silent.loop().done() == (tick + 1 >= 1000));
    }
    told.tick(true, true);
    CHECK(told.loop().done());
    CHECK(told.loop().cause() == StopCause::bus_lost);
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
        double largest_step = 0;
        for (int tick = 0; tick < 250; ++tick) {
            const double next = bench.tick(fault.input);
            largest_step = std::max(largest_step, std::abs(next - last));
            last = next;
        }
        CHECK(bench.loop().state() == LoopState::stopped);
        CHECK(bench.loop().cause() == fault.cause);
        CHECK(largest_step <= 0.2 + 1e-9); // 20 N·m in 0.1 s
        CHECK(last == Approx(weight(bench.position()[0])).margin(1e-3));
    }
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
