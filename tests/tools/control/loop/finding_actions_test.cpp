// SPDX-License-Identifier: Apache-2.0
// Actions of a loop in response to changes that the learner's monitor has identified.
#include "tools/control/loop/finding_actions.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tests/tools/control/pendulum.hpp"
#include "tests/tools/simulation/faults/read_faults.hpp"
#include "tools/base/text/error.hpp"
#include "tools/control/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace finding_actions_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using dfdyn::Cause;

/// Result of a run with a fault: a loop without observer on a pendulum with friction.
struct Outcome {
    std::vector<TakenAction> actions;
    LoopState state = LoopState::waiting;
    StopCause cause = StopCause::none;
    double end_s = 0;
    std::vector<double> error; ///< root mean square over all joints, rad, per second

    /// Root mean square of the seconds `from` to `to` - 1, rad.
    double rms(std::size_t from, std::size_t to) const {
        double square = 0;
        for (std::size_t second = from; second < to; ++second) {
            square += error.at(second) * error.at(second);
        }
        return std::sqrt(square / static_cast<double>(to - from));
    }
};

Outcome run(const std::string& fault, const std::vector<std::string>& choices, double duration_s) {
    Scenario scenario = pendulum_scenario();
    scenario.task =
        MultisineTask{JointVector::Constant(1, 0.3), JointVector::Constant(1, 0.9), 0.1, 0.8, 6, 2};
    LuGreParameters friction;
    friction.stiffness = 2000;
    friction.damping = 5;
    friction.viscous = 0.4;
    friction.coulomb = 0.8;
    friction.breakaway = 1;
    friction.stribeck_velocity = 0.1;
    scenario.actuators.friction = {friction};
    scenario.faults = faults_of(fault, 1);
    DFDYN_SEEDED_ENGINE(engine);
    LoopModel model{unlearned_model(engine, 1, 0.008, {"tau1"}, 40), "model", true};
    model.model.forgetting_factor = 0.9998;
    LoopLimits limits;
    limits.observer_bandwidth = {0};
    limits.actions = FindingActions(choices, "--on-finding");
    ClosedLoop loop(test_pendulum(), scenario, "test", &model, nullptr, limits);
    Tracking tracking(1, 1 / scenario.controller.rate_hz);
    Outcome outcome;
    loop.run_to(duration_s, [&](const ClosedLoopInstant& instant) {
        tracking.add(instant.time_s, instant.error, loop.loop().feed_forward().learned_share());
        outcome.end_s = instant.time_s;
    });
    for (const TrackingWindow& window : tracking.windows()) {
        outcome.error.push_back(window.all);
    }
    outcome.actions = loop.loop().actions();
    outcome.state = loop.loop().state();
    outcome.cause = loop.loop().cause();
    return outcome;
}

std::string refusal(const std::vector<std::string>& choices) {
    try {
        const FindingActions actions(choices, "--on-finding");
    } catch (const InputError& error) {
        return error.what();
    }
    return "none";
}

TEST_CASE("each cause has the chosen action and by default is only reported") {
    const FindingActions actions({"friction_changed=relearn", "bias_moved=compensate", "sensor_frozen=stop"},
                                 "--on-finding");
    CHECK(actions.of(Cause::friction) == FindingAction::relearn);
    CHECK(actions.of(Cause::bias) == FindingAction::compensate);
    CHECK(actions.of(Cause::frozen) == FindingAction::stop);
    CHECK(actions.of(Cause::payload) == FindingAction::report);
    CHECK(FindingActions().of(Cause::friction) == FindingAction::report);
}

TEST_CASE("an action that does not suit its cause is rejected and the suitable ones are listed") {
    CHECK(refusal({"external_contact=stop"}) == "none");
    CHECK(refusal({"external_contact=relearn"}) ==
          "--on-finding: external_contact: expected report, stop, found \"relearn\"");
    CHECK(refusal({"payload=compensate"}) ==
          "--on-finding: payload: expected report, relearn, stop, found \"compensate\"");
    CHECK(refusal({"bias_moved"}) ==
          "--on-finding: bias_moved: expected report, relearn, compensate, stop, found \"\"");
    CHECK(refusal({"friction=relearn"}) ==
          "--on-finding: expected CAUSE=ACTION with one of the causes unknown, payload, friction_changed, "
          "bias_moved, external_contact, sensor_frozen, found \"friction\"");
}

TEST_CASE("after tripled friction a learner that relearns recovers no later") {
    const std::string fault = R"([{"kind": "friction_step", "factor": 3, "from_s": 24}])";
    const Outcome without = run(fault, {}, 42);
    const Outcome with = run(fault, {"friction_changed=relearn"}, 42);
    CHECK(without.actions.empty());
    REQUIRE_FALSE(with.actions.empty());
    CHECK(with.actions.front().cause == Cause::friction);
    CHECK(with.actions.front().time_s < 30);
    CHECK(with.rms(24, 41) <= without.rms(24, 41));
    CHECK(with.rms(32, 41) < without.rms(32, 41));
}

TEST_CASE("compensating a torque offset worsens no second by more than a tenth and improves the whole") {
    const std::string fault = R"([{"kind": "push", "joint": 1, "torque_nm": 2.5, "from_s": 24}])";
    const Outcome without = run(fault, {}, 36.5);
    const Outcome with = run(fault, {"bias_moved=compensate"}, 36.5);
    REQUIRE_FALSE(with.actions.empty());
    CHECK(with.actions.front().cause == Cause::bias);
    CHECK(with.actions.front().joint == 0);
    for (std::size_t second = 24; second < 36; ++second) {
        CAPTURE(second);
        CHECK(with.error.at(second) < 1.1 * without.error.at(second));
    }
    CHECK(with.rms(24, 36) < without.rms(24, 36));
}

TEST_CASE("a change with the action stop stops the loop within four seconds and is named as the cause") {
    const std::string fault = R"([{"kind": "friction_step", "factor": 3, "from_s": 40}])";
    const Outcome outcome = run(fault, {"friction_changed=stop"}, 46);
    CHECK(outcome.state == LoopState::stopped);
    CHECK(outcome.cause == StopCause::finding);
    CHECK(std::string(name(outcome.cause)) == "finding");
    REQUIRE(outcome.actions.size() == 1);
    CHECK(outcome.actions.front().cause == Cause::friction);
    CHECK(outcome.actions.front().time_s < 43.5);
    CHECK(outcome.end_s < 44);
}

TEST_CASE("the first stop is kept when later reactions follow") {
    TakenActions actions;
    CHECK_FALSE(actions.stop());
    actions.add({1, Cause::friction, 0, FindingAction::stop});
    actions.add({1, Cause::contact, 1, FindingAction::hold}); // in the same tick
    actions.add({1, Cause::contact, 1, FindingAction::stop});
    REQUIRE(actions.stop());
    CHECK(actions.stop()->cause == Cause::friction);
    CHECK(actions.list().size() == 3);
    for (int i = 0; i < 100; ++i) {
        actions.add({2, Cause::contact, 1, FindingAction::yield});
    }
    CHECK(actions.list().size() == 64);
}

TEST_CASE("a full list of reactions still contains the stop") {
    TakenActions actions;
    for (int i = 0; i < 100; ++i) {
        actions.add({2, Cause::friction, 1, FindingAction::relearn});
    }
    actions.add({3, Cause::bias, 0, FindingAction::stop});
    CHECK(actions.list().size() == 65);
    CHECK(actions.stop()->cause == Cause::bias);
}

} // namespace finding_actions_test
