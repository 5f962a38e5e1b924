// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/control/loop_margin.hpp"

#include "dfdyn/control/disturbance_observer.hpp"
#include "tests/firmware_lib/control/joint.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace loop_margin_test {

using namespace dfdyn;
using namespace dfdyn::tests;

constexpr double step_s = 2e-5;

JointLoop<double> random_loop(std::mt19937_64& engine) {
    std::uniform_real_distribution<double> unit(0, 1);
    JointLoop<double> loop{};
    loop.inertia = std::pow(10, -2 + 3 * unit(engine));
    const double frequency = 10 + 20 * unit(engine); // rad/s, for PD alone
    const double damping = 0.7 + 0.8 * unit(engine);
    loop.position_gain = loop.inertia * frequency * frequency;
    loop.velocity_gain = 2 * damping * loop.inertia * frequency;
    loop.delay_s = 0.001 + 0.002 * unit(engine);
    loop.velocity_delay_s = 0.005 * unit(engine);
    return loop;
}

/// Returns the largest position in the first and in the last tenth of the 10 s after a small impulse.
std::pair<double, double> after_a_blow(const JointLoop<double>& loop, double observer_inertia,
                                       double bandwidth) {
    constexpr double unlimited = std::numeric_limits<double>::infinity();
    ServoJoint joint(loop, step_s);
    DisturbanceObserver<double, 1> observer({}, {step_s, {{bandwidth}}, {{1e9}}, {{1e9}}, {{unlimited}}});
    joint.advance(1e-3 * loop.inertia / step_s);
    std::pair<double, double> largest{0, 0};
    constexpr int steps = static_cast<int>(10 / step_s);
    for (int i = 0; i < steps; ++i) {
        const double feedback = joint.feedback();
        const double rate = joint.error_rate();
        constexpr double none = 0;
        joint.advance(feedback + observer.update(&feedback, &observer_inertia, &rate, &none)[0]);
        double& phase = i < steps / 10 ? largest.first : largest.second;
        if (i < steps / 10 || i >= steps - steps / 10) {
            phase = std::max(phase, std::abs(joint.position()));
        }
    }
    return largest;
}

TEST_CASE("a joint with pure damping has the phase margin of the closed form") {
    JointLoop<double> loop{2, 1e-9, 30, 0.004, 0};
    const double crossover = loop.velocity_gain / loop.inertia;
    const LoopMargin<double> margin(loop, loop.inertia);
    CHECK(margin.phase(0) == Approx(std::numbers::pi / 2 - crossover * loop.delay_s).margin(1e-6));
    // An observer of bandwidth b with the correct inertia adds b, which acts as damping, to the crossover
    // D/J.
    const double b = 10;
    loop.velocity_gain = 0;
    loop.position_gain = 1e-9;
    CHECK(LoopMargin<double>(loop, loop.inertia).phase(b) ==
          Approx(std::numbers::pi / 2 - b * loop.delay_s).margin(1e-6));
}

TEST_CASE("a joint converges if the phase margin is positive and oscillates if it is negative") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 12; ++trial) {
        const JointLoop<double> loop = random_loop(engine);
        const double observer_inertia = loop.inertia * (trial % 3) / 2;
        const LoopMargin<double> margin(loop, observer_inertia);
        const double edge = margin.largest_bandwidth(0, 1e4);
        REQUIRE(edge > 0);
        CAPTURE(trial, loop.inertia, loop.position_gain, loop.velocity_gain, edge);
        const auto [begin, end] = after_a_blow(loop, observer_inertia, 0.85 * edge);
        CHECK(end < begin / 2);
        CHECK(after_a_blow(loop, observer_inertia, 1.2 * edge).second > 100 * begin);
    }
}

TEST_CASE("the largest bandwidth leaves the requested phase margin") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr double wanted = 0.5;
    for (int trial = 0; trial < 100; ++trial) {
        const JointLoop<double> loop = random_loop(engine);
        const LoopMargin<double> margin(loop, loop.inertia);
        const double bandwidth = margin.largest_bandwidth(wanted, 1e4);
        CAPTURE(trial, bandwidth);
        if (bandwidth > 0) {
            CHECK(margin.phase(bandwidth) == Approx(wanted).margin(1e-3));
        } else {
            CHECK(margin.phase(0) < wanted);
        }
        for (const double share : {0.9, 0.5, 0.1}) {
            CHECK((bandwidth == 0 || margin.phase(share * bandwidth) >= wanted - 1e-3));
        }
    }
}

} // namespace loop_margin_test
