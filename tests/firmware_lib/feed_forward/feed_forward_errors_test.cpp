// SPDX-License-Identifier: Apache-2.0
// How a feed-forward compares the errors of forecasts, and what a tick costs.
#include "tests/firmware_lib/feed_forward/scripted_learner.hpp"
#include "tests/firmware_lib/support/counted.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>

namespace feed_forward_errors_test {

using namespace dfdyn;
using namespace dfdyn::tests;
using namespace dfdyn::tests::scripted;

/// A feed-forward with an observer.
struct ObservedRun {
    ScriptedLearner learner;
    Forward forward;
    bool compares = true;
    int tick = 0;

    static Forward::Settings beside(double bandwidth, double observer_limit) {
        Forward::Settings result = settings;
        result.bandwidth = {{bandwidth}};
        result.observer_limit = {{observer_limit}};
        return result;
    }
    ObservedRun(double bandwidth, double observer_limit)
        : forward(learner, beside(bandwidth, observer_limit)) {
        constexpr double start = 0;
        forward.begin(0, &start);
    }

    /// Runs ticks whose final command is `needed`; `forecast`: by the count of knots.
    void go(double seconds, double nominal, double needed, const std::function<double(int)>& forecast) {
        const auto end = tick + std::llround(seconds / period_s);
        for (; tick < end; ++tick) {
            learner.forecast = forecast(tick / ticks_per_sample);
            forward.update({}, &nominal);
            if (compares) {
                forward.commanded(&needed);
            }
            forward.measured(0, &nominal, &needed);
        }
    }
};

TEST_CASE("with an observer a fast error of a forecast counts more than a slow one") {
    const auto share_with = [](double bandwidth) {
        ObservedRun run(bandwidth, 100);
        run.go(4, 10, 50, [](int knot) { return 50 + (knot % 2 == 0 ? 40 : -40); }); // ±20 in the tick
        return run.forward.share()[0];
    };
    CHECK(share_with(0) > 0.9);
    CHECK(share_with(20) < 0.2);
}

/// Share of a forecast that is wrong by 90 N·m, beside a nominal torque that is wrong by ±40.
double share_beside(double observer_limit, double bandwidth_share) {
    ObservedRun run(20, observer_limit);
    run.forward.observer_bandwidth_share(0, bandwidth_share);
    for (int knot = 0; knot < 500; ++knot) {
        run.go(ticks_per_sample * period_s, knot % 2 == 0 ? 40 : -40, 0, [](int) { return 90; });
    }
    return run.forward.share()[0];
}

TEST_CASE("a constant error counts only beyond the observer's limit") {
    CHECK(share_beside(100, 1) > 0.7);
    CHECK(share_beside(30, 1) < 0.2);
}

TEST_CASE("a constant error counts if vibrations lowered the observer's bandwidth") {
    CHECK(share_beside(100, 1.0 / 256) < 0.2);
    for (const double wrong : {-1.0, 2.0, std::numeric_limits<double>::quiet_NaN()}) {
        CHECK(share_beside(100, wrong) > 0.7);
    }
}

TEST_CASE("a forecast that was absurd at one knot is used again within a second") {
    for (const double absurd : {1e20, -1e300, 1e5}) {
        CAPTURE(absurd);
        ObservedRun run(20, 30);
        const auto right = [](int knot) { return knot % 2 == 0 ? 49 : 51; };
        run.go(3, 10, 50, right);
        REQUIRE(run.forward.share()[0] > 0.95);
        run.go(ticks_per_sample * period_s, 10, 50, [=](int) { return absurd; });
        run.go(1, 10, 50, right);
        CHECK(run.forward.share()[0] > 0.95);
    }
}

TEST_CASE("the slow error of a forecast decays while nothing is compared") {
    ObservedRun run(2, 100);
    run.go(6, 5, 0, [](int) { return 60; });
    run.compares = false;
    run.go(3, 5, 0, [](int) { return 60; });
    run.compares = true; // now the forecast is right, and the nominal torque is wrong in both directions
    for (int knot = 0; knot < 200; ++knot) {
        run.go(ticks_per_sample * period_s, knot % 2 == 0 ? 15 : -15, 0, [](int) { return 0; });
    }
    CHECK(run.forward.share()[0] > 0.7);
}

/// A learner of two forecasts of two torques, whose own operations are not counted.
struct CountedLearner {
    using Scalar = Counted<double>;
    static constexpr int outputs = 2;
    static constexpr int forecasts = 2;
    [[nodiscard]] static constexpr Extent<2> forecast_count() noexcept { return {}; }
    [[nodiscard]] static constexpr Extent<2> output_count() noexcept { return {}; }
    void begin(std::int64_t /*time_ns*/, const Scalar* /*position*/) {}
    void learn(std::int64_t /*time_ns*/, const Scalar* /*position*/, const Scalar* /*torque*/) {}
    void go_on() {}
    bool predict(std::int64_t time_ns, const Scalar* /*position*/, Scalar* torque) {
        for (int i = 0; i < outputs * forecasts; ++i) {
            torque[i] = std::sin(1e-9 * static_cast<double>((1 + i) * time_ns));
        }
        if (++knots % 10 == 0) { // the last forecast of the last joint is unknown
            torque[outputs * forecasts - 1] = std::numeric_limits<double>::quiet_NaN();
        }
        return true;
    }

    int knots = 0;
};

TEST_CASE("a feed-forward of several forecasts costs at most its declared cost") {
    using Torques = FeedForward<CountedLearner>::Torques;
    CountedLearner learner;
    FeedForward<CountedLearner> forward(learner, {.period_ns = period_ns,
                                                  .ticks_per_sample = ticks_per_sample,
                                                  .limit = {{100, 100}},
                                                  .cap = {{60, 60}},
                                                  .rate = {{2000, 2000}},
                                                  .bandwidth = {{20, 20}},
                                                  .observer_limit = {{30, 30}}});
    const Torques nominal{{0.3, 0.4}};
    forward.begin(0, nominal.data());
    std::int64_t most[2] = {0, 0}; // between knots, at knots
    for (int tick = 0; tick < 2000; ++tick) {
        const std::int64_t before = counted_operations;
        forward.update({}, nominal.data());
        const int knot = tick / ticks_per_sample;
        if (knot % 25 != 0) { // after a knot without comparison the slow errors fade, too
            forward.commanded(nominal.data());
        }
        std::int64_t& largest = most[tick % ticks_per_sample == 0 ? 1 : 0];
        largest = std::max(largest, counted_operations - before);
    }
    for (const bool at_knot : {false, true}) {
        CAPTURE(at_knot);
        CHECK(most[at_knot] <= forward.cost(at_knot));
        CHECK(most[at_knot] >= forward.cost(at_knot) - 20); // part of it arises with known noise only
    }
    std::int64_t late = 0; // the comparison of a command that comes after the knot
    for (int tick = 0; tick < 200; ++tick) {
        const std::int64_t before = counted_operations;
        forward.update({}, nominal.data());
        if (tick % ticks_per_sample != 0) {
            forward.commanded(nominal.data());
        }
        late = std::max(late, counted_operations - before);
    }
    CHECK(late <= forward.cost(true));
}

TEST_CASE("a nominal torque that is not finite is replaced by the last finite one") {
    ObservedRun run(0, 0);
    run.go(0.1, 10, 10, [](int) { return 10; });
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        CHECK(run.forward.update({}, &bad)[0] == Approx(10));
    }
    const double good = 12;
    CHECK(run.forward.update({}, &good)[0] == Approx(12));
}

TEST_CASE("settings outside their ranges give no torque") {
    const double nominal = 10;
    const auto torque_with = [&](const Forward::Settings& wrong) {
        ScriptedLearner learner;
        Forward forward(learner, wrong);
        CHECK_FALSE(forward.settings_valid());
        constexpr double start = 0;
        forward.begin(0, &start);
        double largest = 0;
        for (int tick = 0; tick < 5000; ++tick) {
            largest = std::max(largest, std::abs(forward.update({}, &nominal)[0]));
            forward.commanded(&nominal);
            forward.measured(0, &start, &nominal);
        }
        return largest;
    };
    const auto with = [](auto change) {
        Forward::Settings wrong = settings;
        change(wrong);
        return wrong;
    };
    for (const double value :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1.0}) {
        CAPTURE(value);
        CHECK(torque_with(with([&](auto& wrong) { wrong.limit[0] = value; })) == 0);
        CHECK(torque_with(with([&](auto& wrong) { wrong.cap[0] = value; })) == 0);
        CHECK(torque_with(with([&](auto& wrong) { wrong.rate[0] = value; })) == 0);
        CHECK(torque_with(with([&](auto& wrong) { wrong.rise_s = value; })) == 0);
        CHECK(torque_with(with([&](auto& wrong) { wrong.fall_s = value; })) == 0);
        CHECK(torque_with(with([&](auto& wrong) { wrong.memory_s = value; })) == 0);
        CHECK(torque_with(with([&](auto& wrong) { wrong.slow_share = value; })) == 0);
        CHECK(torque_with(with([&](auto& wrong) { wrong.bandwidth[0] = value; })) == 0);
        CHECK(torque_with(with([&](auto& wrong) { wrong.observer_limit[0] = value; })) == 0);
    }
    const double loop_rate = 1 / period_s; // rad/s: the observer would be unstable
    CHECK(torque_with(with([&](auto& wrong) { wrong.bandwidth[0] = 1.001 * loop_rate; })) == 0);
    CHECK(torque_with(with([](auto& wrong) { wrong.ticks_per_sample = 0; })) == 0);
    CHECK(torque_with(with([](auto& wrong) { wrong.period_ns = 0; })) == 0);
}

} // namespace feed_forward_errors_test
