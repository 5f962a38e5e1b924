// SPDX-License-Identifier: Apache-2.0
// Reactions of a loop to contacts, which are detected from the learner's errors.
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tests/tools/control/faulty_loop.hpp"
#include "tests/tools/control/pendulum.hpp"
#include "tests/tools/simulation/faults/read_faults.hpp"
#include "tools/base/text/error.hpp"
#include "tools/control/closed_loop.hpp"
#include "tools/control/loop/pausable_task.hpp"
#include "tools/control/report/loop_summary.hpp"

#include <cmath>
#include <sstream>
#include <string>

namespace contact_reaction_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

constexpr double learned_s = 20; ///< before the runs with a push
constexpr double push_s = 6, push_nm = 2.5;

Scenario scenario_with(const std::string& fault) {
    Scenario scenario = pendulum_scenario();
    scenario.task =
        MultisineTask{JointVector::Constant(1, 0.3), JointVector::Constant(1, 0.9), 0.1, 0.8, 6, 2};
    scenario.faults = faults_of(fault, 1);
    return scenario;
}

/// A model that has learned the pendulum, with limits of contacts of 1 N·m.
LoopModel learned_model() {
    DFDYN_SEEDED_ENGINE(engine);
    LoopModel model{unlearned_model(engine, 1, 0.008, {"tau1"}, 40), "model", true};
    model.model.contact = {.limit = {1, 1, 1},
                           .usual = {0.1, 0.1, 0.1},
                           .relative = {0.1},
                           .speed = {10},
                           .acceleration = {1000},
                           .rate_slope = 0.05};
    ClosedLoop loop(test_pendulum(), scenario_with("[]"), "test", &model);
    loop.run_to(learned_s, [](const ClosedLoopInstant&) {});
    model.learned = loop.loop().feed_forward().learned()->snapshot();
    return model;
}

/// Outcome of a run from the start of a push.
struct Outcome {
    std::vector<TakenAction> actions;
    std::vector<PushReaction> reactions;
    LoopState state = LoopState::waiting;
    StopCause cause = StopCause::none;
    double speed_after = 0;  ///< rad/s, largest of the reference from 1 s after the push
    double error_after = 0;  ///< rad, of the reference at the end of the run
    double jump = 0;         ///< rad, of the reference from its stop to the end of the run
    double moved = 0;        ///< rad, by the push
    double error_at_end = 0; ///< rad, of the reference at the end of the push
    double command = 0;      ///< N·m, in the last 0.1 s of the push, mean
    double gravity = 0;      ///< N·m, mean over the same time
    std::uint64_t learned_in_contact = 0;
    int contact_lost = 0; ///< ticks of the push after the reaction without a contact
    std::string summary;
};

/// Takes an outcome from a loop while it runs.
class Watch {
  public:
    Watch(ClosedLoop& loop, double end_of_push_s) : loop_(loop), end_s_(end_of_push_s) {}

    void observe(const ClosedLoopInstant& instant) {
        const double q = loop_.plant().truth().position[0];
        if (instant.time_s < push_s) {
            at_push_ = q;
        } else if (instant.time_s < end_s_) {
            observe_push(instant, q);
        } else if (instant.time_s >= end_s_ + 1) {
            const Reference& reference = loop_.loop().reference();
            outcome_.speed_after = std::max(outcome_.speed_after, std::abs(reference.velocity[0]));
            outcome_.error_after = std::abs(instant.error[0]);
            outcome_.jump = std::abs(reference.position[0] - stopped_at_);
        }
    }

    Outcome outcome() {
        const ControlLoop& loop = loop_.loop();
        outcome_.command /= std::max(pressed_, 1);
        outcome_.gravity /= std::max(pressed_, 1);
        outcome_.actions = loop.actions();
        outcome_.reactions = loop_.reactions();
        outcome_.state = loop.state();
        outcome_.cause = loop.cause();
        std::ostringstream text;
        print_loop(text, loop);
        print_reactions(text, loop_.reactions());
        outcome_.summary = text.str();
        return outcome_;
    }

  private:
    void observe_push(const ClosedLoopInstant& instant, double q) {
        const FeedForward& feed_forward = loop_.loop().feed_forward();
        const std::uint64_t samples = feed_forward.learned()->counters().learned;
        outcome_.moved = std::max(outcome_.moved, std::abs(q - at_push_));
        outcome_.error_at_end = std::abs(instant.error[0]);
        const bool reacted = !loop_.loop().actions().empty();
        outcome_.contact_lost += reacted && feed_forward.contact_joint() < 0 ? 1 : 0;
        stopped_at_ = loop_.loop().reference().position[0];
        learned_ = instant.time_s < push_s + 0.15 ? samples : learned_;
        outcome_.learned_in_contact = samples - learned_;
        if (instant.time_s >= end_s_ - 0.1) {
            outcome_.command += instant.command[0];
            outcome_.gravity += weight(q);
            ++pressed_;
        }
    }

    ClosedLoop& loop_;
    double end_s_;
    Outcome outcome_;
    double at_push_ = 0, stopped_at_ = 0;
    int pressed_ = 0;
    std::uint64_t learned_ = 0;
};

Outcome run_with(FindingAction reaction, const std::string& faults, double for_s,
                 const BusDescription* bus = nullptr) {
    LoopModel model = learned_model();
    LoopLimits limits;
    limits.on_contact = reaction;
    ClosedLoop loop(test_pendulum(), scenario_with(faults), "test", &model, bus, limits);
    Watch watch(loop, push_s + for_s);
    loop.run_to(16, [&](const ClosedLoopInstant& instant) { watch.observe(instant); });
    return watch.outcome();
}

Outcome run(FindingAction reaction, double size_nm = push_nm, double for_s = 0.3,
            const BusDescription* bus = nullptr) {
    const std::string push = R"([{"kind": "push", "joint": 1, "torque_nm": )" + std::to_string(size_nm) +
                             R"(, "from_s": 6, "for_s": )" + std::to_string(for_s) + "}]";
    return run_with(reaction, push, for_s, bus);
}

void check_detected(const Outcome& outcome, FindingAction reaction) {
    REQUIRE(outcome.actions.size() == 1);
    CHECK(outcome.actions.front().action == reaction);
    CHECK(outcome.actions.front().cause == dfdyn::Cause::contact);
    CHECK(outcome.actions.front().joint == 0);
    REQUIRE(outcome.reactions.size() == 1);
    CHECK(outcome.reactions.front().push_s == Approx(push_s).margin(0.002));
    CHECK(outcome.reactions.front().after_s < 0.1);
    const double first_command_s = outcome.actions.front().time_s + 0.001; // one period later
    CHECK(outcome.reactions.front().after_s ==
          Approx(first_command_s - outcome.reactions.front().push_s).margin(1e-6));
    CHECK(outcome.summary.find("ms after the push at 6.00 s") != std::string::npos);
}

TEST_CASE("a loop that stops at a contact stops within a tenth of a second and names it", "[contacts]") {
    const Outcome outcome = run(FindingAction::stop);
    check_detected(outcome, FindingAction::stop);
    CHECK(outcome.state == LoopState::stopped);
    CHECK(outcome.cause == StopCause::finding);
    CHECK(outcome.summary.find("finding: external_contact at joint 1") != std::string::npos);
}

TEST_CASE("a loop names a contact of any size within a tenth of a second", "[contacts]") {
    for (const double size_nm : {6.0, 9.0, 12.0, 16.0, 20.0}) {
        CAPTURE(size_nm);
        const Outcome outcome = run(FindingAction::stop, size_nm);
        CHECK(outcome.cause == StopCause::finding);
        REQUIRE(outcome.actions.size() == 1);
        CHECK(outcome.actions.front().cause == dfdyn::Cause::contact);
        CHECK(outcome.actions.front().time_s >= push_s);
        CHECK(outcome.actions.front().time_s < push_s + 0.1);
    }
}

TEST_CASE("a loop also names a contact while frames are lost, and none without a push", "[contacts]") {
    const BusDescription bus = one_drive(at_sync);
    for (const double lost : {0.01, 0.02, 0.05}) {
        CAPTURE(lost);
        const std::string frames =
            R"({"kind": "frames_lost", "share": )" + std::to_string(lost) + R"(, "from_s": 0, "for_s": 16})";
        CHECK(run_with(FindingAction::stop, "[" + frames + "]", 0.3, &bus).actions.empty());
        const Outcome outcome = run_with(
            FindingAction::stop,
            "[" + frames + R"(, {"kind": "push", "joint": 1, "torque_nm": 2.5, "from_s": 6, "for_s": 0.3}])",
            0.3, &bus);
        CHECK(outcome.cause == StopCause::finding);
        REQUIRE(outcome.actions.size() == 1);
        CHECK(outcome.actions.front().time_s >= push_s);
        CHECK(outcome.actions.front().time_s < push_s + 0.15);
    }
}

TEST_CASE("a loop that holds at a contact stops on its path and stays there", "[contacts]") {
    const Outcome outcome = run(FindingAction::hold, push_nm, 0.8);
    check_detected(outcome, FindingAction::hold);
    CHECK(outcome.state == LoopState::running);
    CHECK(outcome.learned_in_contact == 0);
    CHECK(outcome.error_at_end ==
          Approx(push_nm / 50).epsilon(0.05)); // the position gain alone bears the push
    CHECK(outcome.speed_after == 0);
    CHECK(outcome.jump == 0);
    CHECK(outcome.error_after < 1e-3);
}

/// Checks a run with a push to which the loop yields.
void check_yields(const Outcome& outcome) {
    check_detected(outcome, FindingAction::yield);
    CHECK(outcome.state == LoopState::running);
    CHECK(outcome.learned_in_contact == 0);
    CHECK(outcome.contact_lost == 0);
    CHECK(outcome.command == Approx(outcome.gravity).margin(0.05));
    CHECK(outcome.speed_after == 0);
    CHECK(outcome.jump > 0.1);
    CHECK(outcome.error_after < 1e-3);
}

TEST_CASE("a loop that yields at a contact has gravity torque alone and holds where it was pushed",
          "[contacts]") {
    const Outcome outcome = run(FindingAction::yield);
    check_yields(outcome);
    CHECK(outcome.moved > 2 * run(FindingAction::hold).moved);
}

TEST_CASE("a loop also yields with a delay of the bus", "[contacts]") {
    const BusDescription bus = one_drive(at_sync);
    check_yields(run(FindingAction::yield, push_nm, 0.3, &bus));
}

TEST_CASE("after a contact that does not end the motion remains stopped", "[contacts]") {
    const Outcome outcome = run(FindingAction::hold, push_nm, 8);
    CHECK(outcome.state == LoopState::running);
    CHECK(outcome.actions.size() == 1);
    CHECK(outcome.speed_after == 0);
}

TEST_CASE("a stop during a contact leaves the push out of the torque that holds the arm", "[contacts]") {
    LoopModel model = learned_model();
    LoopLimits limits;
    limits.on_contact = FindingAction::hold;
    FaultyLoop arm(
        test_pendulum(),
        scenario_with(R"([{"kind": "push", "joint": 1, "torque_nm": 2.5, "from_s": 6, "for_s": 9}])"),
        one_drive(at_sync), &model, limits);
    arm.run_to(6.7);
    const double before = arm.plant().truth().position[0];
    arm.run_to(8, [](int) {
        LoopFault fault;
        fault.given.stop_requested = true;
        return fault;
    });
    const double moved = arm.plant().truth().position[0] - before;
    CHECK(std::abs(moved) == Approx(push_nm / 50).epsilon(0.1)); // the position gain alone bears the push
}

TEST_CASE("without a push, or without a chosen reaction, a loop does nothing about contacts", "[contacts]") {
    CHECK(run(FindingAction::hold, 0).actions.empty());
    const Outcome outcome = run(FindingAction::report);
    CHECK(outcome.actions.empty());
    CHECK(outcome.state == LoopState::running);
}

TEST_CASE("a loop with a reaction to contacts rejects a model without contact limits", "[contacts]") {
    LoopModel model = learned_model();
    model.model.contact = {};
    LoopLimits limits;
    limits.on_contact = FindingAction::hold;
    CHECK_THROWS_AS(ClosedLoop(test_pendulum(), scenario_with("[]"), "test", &model, nullptr, limits),
                    InputError);
    CHECK_THROWS_AS(contact_action("wait", "--on-contact"), InputError);
    CHECK(contact_action("yield", "--on-contact") == FindingAction::yield);
}

std::unique_ptr<Task> sine_task() {
    return make_task(
        MultisineTask{JointVector::Constant(1, 0.3), JointVector::Constant(1, 0.9), 0.1, 0.8, 6, 2},
        test_pendulum(), 0.002, 5);
}

/// Checks that velocities and accelerations are the differences of positions and velocities.
void check_smooth(const std::vector<Reference>& path) {
    for (std::size_t i = 1; i < path.size(); ++i) {
        const double velocity = (path[i].position[0] - path[i - 1].position[0]) / 0.002;
        REQUIRE(velocity == Approx((path[i].velocity[0] + path[i - 1].velocity[0]) / 2).margin(0.02));
    }
}

TEST_CASE("a task without a pause is unchanged", "[contacts]") {
    const std::unique_ptr<Task> plain = sine_task();
    PausableTask task(sine_task(), 0.002);
    for (int i = 0; i < 5000; ++i) {
        const Reference expected = plain->next(), found = task.next();
        REQUIRE(found.position == expected.position);
        REQUIRE(found.velocity == expected.velocity);
        REQUIRE(found.acceleration == expected.acceleration);
    }
}

TEST_CASE("a paused task rests on its path permanently", "[contacts]") {
    PausableTask task(sine_task(), 0.002);
    std::vector<Reference> path;
    for (int i = 0; i < 5000; ++i) {
        path.push_back(task.next());
        if (i == 2500) {
            task.pause();
        }
    }
    check_smooth(path);
    const auto rest = static_cast<std::size_t>(2502 + std::lround(PausableTask::pause_s / 0.002));
    CHECK(path[rest].velocity[0] == 0);
    CHECK(path[rest].acceleration[0] == 0);
    CHECK(path.back().position == path[rest].position);
}

} // namespace contact_reaction_test
