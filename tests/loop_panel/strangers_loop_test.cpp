// SPDX-License-Identifier: Apache-2.0
// Loops of arms, gains, filters, buses and motions that differ from seed to seed. No limit of the loop was
// chosen for one of them.
#include "tests/loop_panel/loop_trial.hpp"
#include "tests/loop_panel/strangers_loop.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/control/commissioned_model.hpp"
#include "tests/tools/simulation/faults/read_faults.hpp"
#include "tools/control/loop/control_loop.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace strangers_loop_test {

using namespace dfdyn::tests;
using Catch::Matchers::ContainsSubstring;
using dfdyn::tools::LoopModel;

constexpr double largest_step = 0.1; // of the limit, per tick

/// Draws an arm that its engineer could tune.
StrangersLoop tuned_loop(std::mt19937_64& engine, std::uint64_t& seed) {
    for (;;) {
        seed = engine() % 1'000'000;
        if (const std::optional<StrangersLoop> loop = draw_strangers_loop(seed)) {
            return *loop;
        }
    }
}

/// Checks a run against the one of the nominal rigid body and feedback alone.
void check(const LoopTrial& trial, const LoopTrial& nominal) {
    CAPTURE(trial.error, nominal.error, nominal.step);
    CHECK(trial.stop.empty());
    CHECK(trial.step < std::max(largest_step, nominal.step + 0.06));
    CHECK(trial.error < nominal.error);
    CHECK(trial.second < 1.1 * nominal.second);
}

void check_observers(int arms) {
    DFDYN_SEEDED_ENGINE(engine);
    for (int arm = 0; arm < arms; ++arm) {
        std::uint64_t seed = 0;
        const StrangersLoop loop = tuned_loop(engine, seed);
        CAPTURE(seed, loop.summary());
        check(run_loop(loop, true, nullptr, 12), run_loop(loop, false, nullptr, 12));
    }
}

TEST_CASE("with the default observer a stranger's arm does not stop or rattle and errs less") {
    check_observers(8);
}

TEST_CASE("with the default observer none of a hundred strangers' arms stops or rattles and each errs less",
          "[.long]") {
    check_observers(100);
}

TEST_CASE("a stranger's arm with an untrained model does not stop or rattle and errs less", "[.long]") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int arm = 0; arm < 20; ++arm) {
        std::uint64_t seed = 0;
        const StrangersLoop loop = tuned_loop(engine, seed);
        CAPTURE(seed, loop.summary());
        const LoopModel model = commissioned_model(loop.robot, loop.scenario);
        check(run_loop(loop, true, &model, 20), run_loop(loop, false, nullptr, 20));
    }
}

TEST_CASE("joints whose feedbacks turn them against each other do not vibrate under the default observer") {
    // Two of its six joints move with an eighth of their own inertias.
    const StrangersLoop loop = draw_strangers_loop(4).value();
    CHECK(run_loop(loop, true, nullptr, 12).step < 0.06);
}

TEST_CASE("links that the default observer makes vibrate on elastic gears are calm within six seconds") {
    // Without a watch commands change by the largest step throughout.
    constexpr double gear_hz = 25;
    for (const std::uint64_t seed : {3, 4, 14}) {
        CAPTURE(seed);
        const StrangersLoop loop = draw_strangers_loop(seed, gear_hz).value();
        const LoopTrial trial = run_loop(loop, true, nullptr, 12);
        CHECK(trial.stop.empty());
        CHECK_THAT(trial.summary, ContainsSubstring("lowered the observer's bandwidth to "));
        CHECK(std::ranges::min(trial.bandwidth_share) < 1);
        const LoopTrial nominal = run_loop(loop, false, nullptr, 12);
        CHECK(trial.error < nominal.error);
        // noise of the readings, also of coarse encoders, may add the observer's step
        CHECK(trial.late_step < nominal.late_step + dfdyn::tools::ControlLoop::observer_step);
        CHECK_THAT(nominal.summary, !ContainsSubstring("bandwidth"));
        CHECK(std::ranges::min(nominal.bandwidth_share) == 1);
    }
}

TEST_CASE("lost frames and cycles and a glitch of an encoder do not stop a stranger's arm or kick it") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<std::string> faults = {
        R"({"kind": "cycles_lost", "cycles": 1, "at_s": 3})",
        R"({"kind": "cycles_lost", "cycles": 3, "at_s": 3})", R"({"kind": "frames_lost", "share": 0.01})",
        R"({"kind": "clock_jump", "clock": "bus", "by_s": -1, "at_s": 3})",
        R"({"kind": "encoder_jump", "joint": 1, "rad": 0.03, "at_s": 3, "for_s": 0.002})"};
    for (int arm = 0; arm < 4; ++arm) {
        std::uint64_t seed = 0;
        StrangersLoop loop = tuned_loop(engine, seed);
        const LoopTrial usual = run_loop(loop, true, nullptr, 5);
        for (const std::string& fault : faults) {
            CAPTURE(seed, loop.summary(), fault, usual.step, usual.speed);
            loop.scenario.faults = faults_of("[" + fault + "]", static_cast<int>(loop.robot.joints.size()));
            const LoopTrial trial = run_loop(loop, true, nullptr, 5);
            CHECK(trial.stop.empty());
            CHECK(trial.step < std::max(1.05 * largest_step, 1.3 * usual.step));
            CHECK(trial.speed < 1.2 * usual.speed);
        }
    }
}

} // namespace strangers_loop_test
