// SPDX-License-Identifier: Apache-2.0
// How a feed-forward treats each joint by itself, and commands and positions that do not come at the knots.
#include "tests/firmware_lib/feed_forward/scripted_learner.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace feed_forward_joints_test {

using namespace dfdyn;
using namespace dfdyn::tests::scripted;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// A learner of two joints whose predictions the test sets.
struct TwoJoints {
    using Scalar = double;
    static constexpr int outputs = 2;
    static constexpr int forecasts = 1;
    [[nodiscard]] static constexpr Extent<1> forecast_count() noexcept { return {}; }
    [[nodiscard]] static constexpr Extent<2> output_count() noexcept { return {}; }
    void begin(std::int64_t /*time_ns*/, const double* /*position*/) {}
    void learn(std::int64_t /*time_ns*/, const double* /*position*/, const double* /*torque*/) {}
    void go_on() {}
    bool predict(std::int64_t /*time_ns*/, const double* /*position*/, double* torque) {
        std::copy_n(forecast, outputs, torque);
        return true;
    }

    double forecast[outputs] = {50, 50};
};

/// Two joints whose final commands are 50 N·m, with nominal torques of 10 N·m.
struct Run {
    TwoJoints learner;
    FeedForward<TwoJoints> forward{learner,
                                   {period_ns, ticks_per_sample, {{100, 100}}, {{60, 60}}, {{2000, 2000}}}};
    double commands[2] = {50, 50};
    std::vector<double> parts; ///< learned part of the second joint, in each tick

    Run() {
        constexpr double start[] = {0, 0};
        forward.begin(0, start);
    }

    void go(double seconds) {
        constexpr double nominal[] = {10, 10};
        for (auto tick = std::llround(seconds / period_s); tick > 0; --tick) {
            forward.update({}, nominal);
            forward.commanded(commands);
            forward.measured(0, nominal, commands);
            parts.push_back(forward.learned_part()[1]);
        }
    }
};

TEST_CASE("a joint without commands does not hide that another joint's forecast has become wrong") {
    Run run;
    run.go(3);
    REQUIRE(run.forward.share()[0] > 0.99);
    run.commands[1] = unknown;         // at its limit, or without an encoder
    run.learner.forecast[0] = 50 - 80; // the nominal torque has an error of 40 N·m
    run.go(1);
    CHECK(run.forward.share()[0] < 0.1);
    CHECK(run.forward.share()[1] > 0.99); // nothing is known against it
}

TEST_CASE("a joint has no learned part before it was compared for a second, however long others were") {
    Run run;
    run.commands[1] = unknown;
    run.go(3);
    CHECK(run.forward.share()[0] > 0.99);
    CHECK(run.forward.share()[1] == 0);
    run.commands[1] = 50;
    run.go(0.9);
    CHECK(run.forward.share()[1] == 0);
    run.go(1);
    CHECK(run.forward.share()[1] > 0.99);
}

TEST_CASE("a joint without a forecast at a knot leaves the learned part of another joint unchanged") {
    const auto parts = [](double forecast) {
        Run run;
        run.go(3);
        run.learner.forecast[0] = forecast;
        run.go(ticks_per_sample * period_s);
        run.learner.forecast[0] = 50;
        run.go(1);
        return run.parts;
    };
    REQUIRE(parts(50).back() == Approx(40).margin(0.01));
    CHECK(parts(unknown) == parts(50));
}

TEST_CASE("positions and commands in every second tick are learned and compared, in any phase") {
    for (const int phase : {0, 1}) {
        CAPTURE(phase);
        ScriptedLearner learner;
        Forward forward(learner, settings);
        constexpr double start = 0;
        forward.begin(0, &start);
        learner.forecast = 50;
        constexpr double nominal = 10, needed = 50;
        for (std::int64_t tick = 0; tick < std::llround(3 / period_s); ++tick) {
            forward.update({}, &nominal);
            const bool has = tick % 2 == phase;
            forward.commanded(has ? &needed : &unknown);
            forward.measured(tick * period_ns, has ? &start : nullptr, &needed);
        }
        CHECK(learner.learned.size() > 300);
        CHECK(forward.share()[0] > 0.9);
    }
}

TEST_CASE("samples without a lost one between them are one sample period apart") {
    ScriptedLearner learner;
    Forward forward(learner, settings);
    constexpr double start = 0;
    forward.begin(0, &start);
    constexpr double none = 0;
    for (std::int64_t tick = 0; tick < 400; ++tick) {
        forward.update({}, &none);
        const bool lost = tick % 100 == 48 || tick % 100 == 49; // 48 is a knot
        forward.measured(tick * period_ns, lost ? nullptr : &start, &none);
    }
    constexpr std::int64_t sample_ns = period_ns * ticks_per_sample;
    int gaps = 0;
    for (std::size_t i = 1; i < learner.learned.size(); ++i) {
        const std::int64_t step_ns = learner.learned[i] - learner.learned[i - 1];
        CHECK((step_ns == sample_ns || step_ns >= 2 * sample_ns)); // else a gap would not be noticed
        gaps += step_ns > sample_ns ? 1 : 0;
    }
    CHECK(gaps >= 1);
    CHECK(learner.learned.size() > 90);
}

} // namespace feed_forward_joints_test
