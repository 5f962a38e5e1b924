// SPDX-License-Identifier: Apache-2.0
#include "tools/control/control_loop.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/simulation/small_arms.hpp"
#include "tools/control/closed_loop.hpp"

#include <cmath>
#include <vector>

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

constexpr double mass = 1, length = 0.5, gravity = 9.81;

Scenario pendulum_scenario() {
    Scenario scenario = quiet_scenario(1);
    scenario.controller.kind = ControllerKind::feed_forward;
    scenario.controller.position_gain = JointVector::Constant(1, 50);
    scenario.controller.velocity_gain = JointVector::Constant(1, 5);
    scenario.actuators.torque_limit = JointVector::Constant(1, 20);
    return scenario;
}

double weight(double position) { return mass * gravity * length * std::sin(position); }

double rms_error(const Scenario& scenario) {
    ClosedLoop loop(pendulum(mass, length), scenario, "test", nullptr);
    double square = 0;
    loop.run_to(5, [&](const ClosedLoopInstant& instant) { square += instant.error.squaredNorm(); });
    CHECK(loop.loop().state() == LoopState::running);
    return std::sqrt(square / 5000);
}

/// A loop about a pendulum that stands at the reference's start, tick by tick.
class Bench {
  public:
    explicit Bench(const Scenario& scenario)
        : loop_(make_control_loop(pendulum(mass, length), scenario, "test", nullptr)),
          position_(loop_->reference().position) {}

    double tick(bool valid = true, bool stop = false) {
        LoopInput input;
        input.time_ns = 1'000'000 * ticks_++;
        input.position = valid ? &position_ : nullptr;
        input.stop_requested = stop;
        return loop_->tick(input)[0];
    }
    ControlLoop& loop() { return *loop_; }
    JointVector& position() { return position_; }

  private:
    std::unique_ptr<ControlLoop> loop_;
    JointVector position_;
    std::int64_t ticks_ = 0;
};

} // namespace

TEST_CASE("with a rigid body that is right the arm follows; a payload that nobody knows of makes the error "
          "of its weight") {
    Scenario scenario = pendulum_scenario();
    CHECK(rms_error(scenario) < 1e-3);
    Payload payload;
    payload.mass = 0.2;
    scenario.payloads = {payload};
    // about 0.3 rad: 0.2 kg of weight over the position gain
    const double sag = 0.2 / mass * weight(0.3) / 50;
    CHECK(rms_error(scenario) == Approx(sag).epsilon(0.5));
}

TEST_CASE("the same closed loop gives the same bits") {
    const auto run = [] {
        Scenario scenario = pendulum_scenario();
        scenario.encoders.noise = 1e-4;
        std::vector<double> commands;
        ClosedLoop loop(pendulum(mass, length), scenario, "test", nullptr);
        loop.run_to(0.5, [&](const ClosedLoopInstant& instant) { commands.push_back(instant.command[0]); });
        return commands;
    };
    CHECK(run() == run());
}

TEST_CASE("no command is beyond the limit, and those at it are counted") {
    Scenario scenario = pendulum_scenario();
    scenario.actuators.torque_limit = JointVector::Constant(1, 1);
    Bench bench(scenario);
    bench.position()[0] -= 0.2; // 10 N·m of feedback
    CHECK(bench.tick() == 1);
    bench.position()[0] += 0.4;
    CHECK(bench.tick() == -1);
    CHECK(bench.loop().counters().limited == 2);
}

TEST_CASE("a loop that loses its positions coasts, then goes over to the weight at the last one") {
    Bench bench(pendulum_scenario());
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
    CHECK(start == Approx(before).margin(0.1)); // no jump
    double last = start;
    for (int tick = 0; tick < 300; ++tick) {
        const double next = bench.tick(false);
        CHECK(std::abs(next - last) < 0.05);
        last = next;
    }
    CHECK(bench.loop().state() == LoopState::stopped);
    CHECK(last == Approx(weight(bench.position()[0])).epsilon(1e-6));
}

TEST_CASE("an arm that does not stand where the motion begins is not touched") {
    Bench bench(pendulum_scenario());
    bench.position()[0] += 1;
    for (int tick = 0; tick < 10; ++tick) {
        CHECK(bench.tick() == 0);
    }
    CHECK(bench.loop().cause() == StopCause::following_error);
    CHECK(bench.loop().counters().running == 0);
}

TEST_CASE("an arm that drifts while the loop holds it is damped") {
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
    CHECK(torque == Approx(weight(bench.position()[0]) - 5 * 1.0).epsilon(1e-3));
}
