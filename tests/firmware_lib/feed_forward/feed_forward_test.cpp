// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/control/feed_forward.hpp"

#include "tests/firmware_lib/control/joint.hpp"
#include "tests/firmware_lib/feed_forward/scripted_learner.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

namespace feed_forward_test {

using namespace dfdyn;
using namespace dfdyn::tests;
using namespace dfdyn::tests::scripted;

Reference<double, 1> reference_at(double time_s) {
    return {{{std::sin(time_s)}}, {{std::cos(time_s)}}, {{-std::sin(time_s)}}};
}

/// Runs a feed-forward in a loop whose final command is `needed`.
struct Run {
    ScriptedLearner learner;
    Forward forward{learner, settings};
    std::int64_t tick = 0;
    double last = 0;
    double largest_step = 0;

    Run() {
        constexpr double start = 0;
        forward.begin(0, &start);
    }

    void go(double seconds, double nominal, double needed) {
        const auto end = tick + std::llround(seconds / period_s);
        for (; tick < end; ++tick) {
            const double time_s = static_cast<double>(tick) * period_s;
            const double torque = forward.update(reference_at(time_s), &nominal)[0];
            forward.commanded(&needed);
            const double position = std::sin(time_s);
            forward.measured(tick * period_ns, &position, &needed);
            largest_step = tick > 0 ? std::max(largest_step, std::abs(torque - last)) : 0;
            last = torque;
        }
    }
};

TEST_CASE("the learned part enters without a step, after a second of comparisons") {
    Run run;
    run.learner.forecast = 50;
    run.go(1.0, 10, 50);
    CHECK(run.last == 10);
    CHECK(run.forward.share()[0] == 0);
    run.go(0.25, 10, 50);
    CHECK(run.forward.share()[0] == Approx(0.5).margin(0.03));
    run.go(0.5, 10, 50);
    CHECK(run.last == Approx(50).margin(0.01));
    CHECK(run.largest_step <= 40 * period_s / 0.5 + 1e-9);
}

TEST_CASE("a wrong learner is excluded within a second, and included when it is correct again") {
    Run run;
    run.learner.forecast = 50;
    run.go(3, 10, 50);
    REQUIRE(run.forward.share()[0] > 0.99);
    run.learner.forecast = -30; // an error of 80 N·m; the nominal torque has an error of 40
    run.go(1, 10, 50);
    CHECK(run.forward.share()[0] < 0.1);
    run.learner.forecast = 50;
    run.go(6, 10, 50);
    CHECK(run.forward.share()[0] > 0.9);
}

TEST_CASE("a learner without a prediction for the next knot loses no weight") {
    Run run;
    run.learner.forecast = 50;
    const double knot_s = ticks_per_sample * period_s;
    for (int knot = 0; knot < 600; ++knot) {
        run.learner.knows = knot % 3 != 0; // it then writes 0
        run.go(knot_s, 45, 50);
    }
    run.learner.knows = true;
    run.go(0.4, 45, 50); // with the errors of a forecast of 0 the share would be 0.2
    CHECK(run.forward.share()[0] > 0.7);
}

TEST_CASE("disabling and enabling cause no step and learning continues in between") {
    Run run;
    run.learner.forecast = 50;
    run.go(3, 10, 50);
    const std::size_t learned = run.learner.learned.size();
    run.forward.enable(false);
    run.largest_step = 0;
    run.go(0.25, 10, 50);
    CHECK(run.last == Approx(10).margin(0.5));
    CHECK(run.learner.learned.size() > learned + 20);
    run.forward.enable(true);
    run.go(1, 10, 50);
    CHECK(run.last == Approx(50).margin(0.01));
    CHECK(run.largest_step <= 40 * period_s / 0.2 + 1e-9);
}

TEST_CASE("torque and learned part and its rate stay within their limits") {
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<double> size(0, 200);
    std::bernoulli_distribution rarely(0.01);
    Run run;
    double part = 0;
    for (int i = 0; i < 5000; ++i) {
        run.learner.forecast = rarely(engine) ? std::numeric_limits<double>::quiet_NaN() : size(engine);
        run.learner.knows = std::isfinite(run.learner.forecast);
        const double nominal = rarely(engine) ? std::numeric_limits<double>::infinity() : size(engine);
        run.go(period_s, nominal,
               rarely(engine) ? std::numeric_limits<double>::quiet_NaN() : run.learner.forecast);
        const double now = run.forward.learned_part()[0];
        REQUIRE(std::abs(run.last) <= 100);
        REQUIRE(std::abs(now) <= 60);
        REQUIRE(std::abs(now - part) <= 2000 * period_s * (1 + 1e-12));
        part = now;
    }
}

TEST_CASE("the learner predicts the reference at the next knot and learns one sample per knot") {
    Run run;
    run.go(10 * ticks_per_sample * period_s, 0, 0);
    CHECK(run.learner.began_at == 0);
    REQUIRE(run.learner.predicted.size() == 10);
    REQUIRE(run.learner.learned.size() == 10);
    CHECK(run.learner.went_on == 10 * (ticks_per_sample - 1));
    for (std::size_t k = 0; k < 10; ++k) {
        const auto next_ns = static_cast<std::int64_t>(k + 1) * ticks_per_sample * period_ns;
        CHECK(run.learner.predicted[k] == next_ns);
        CHECK(run.learner.asked_at[k] == Approx(std::sin(1e-9 * static_cast<double>(next_ns))).margin(1e-7));
        CHECK(run.learner.learned[k] == next_ns - ticks_per_sample * period_ns);
    }
}

TEST_CASE("a missing position is not learned") {
    Run run;
    run.go(0.1, 0, 0);
    const std::size_t learned = run.learner.learned.size();
    constexpr double nothing = 0;
    for (int i = 0; i < 2 * ticks_per_sample; ++i) {
        run.forward.update(reference_at(0.1), &nothing);
        run.forward.commanded(&nothing);
        run.forward.measured(0, nullptr, nullptr);
    }
    CHECK(run.learner.learned.size() == learned);
}

/// A joint under feedback and feed-forward that has to hold a load, tick by tick.
class LoadedJoint {
  public:
    static constexpr double load = 10;

    LoadedJoint() {
        constexpr double start = 0;
        forward_.begin(0, &start);
    }

    void go(double seconds, const std::function<double(double)>& forecast) {
        constexpr int steps = 20;
        largest_error = 0;
        const auto end = tick_ + std::llround(seconds / period_s);
        for (; tick_ < end; ++tick_) {
            learner_.forecast = forecast(static_cast<double>(tick_) * period_s);
            constexpr double nominal = 0;
            const double command = forward_.update({}, &nominal)[0] + joint_.feedback();
            forward_.commanded(&command);
            const double position = joint_.position();
            forward_.measured(tick_ * period_ns, &position, &command);
            for (int i = 0; i < steps; ++i) {
                joint_.advance(command - load);
            }
            largest_error = std::max(largest_error, std::abs(position));
        }
    }
    [[nodiscard]] double share() const { return forward_.share()[0]; }

    double largest_error = 0; ///< rad, of the last call of `go`

  private:
    static constexpr JointLoop<double> servo{2, 800, 80, 0, 0};

    ScriptedLearner learner_;
    Forward forward_{learner_, settings};
    ServoJoint joint_{servo, period_s / 20};
    std::int64_t tick_ = 0;
};

TEST_CASE("a correct forecast is used in a closed loop and a wrong or oscillating one is excluded within a "
          "second") {
    const auto right = [](double /*time_s*/) { return LoadedJoint::load; };
    const auto biased = [](double /*time_s*/) { return LoadedJoint::load + 40; };
    const auto swaying = [](double time_s) {
        return LoadedJoint::load + 40 * std::sin(2 * std::numbers::pi * time_s);
    };
    LoadedJoint joint;
    joint.go(3, right);
    CHECK(joint.share() > 0.95);
    joint.go(1, right);
    const double sag = LoadedJoint::load / 800; // the sag with feedback alone
    CHECK(joint.largest_error < sag / 10);
    for (const auto& wrong :
         {std::function<double(double)>(biased), std::function<double(double)>(swaying)}) {
        LoadedJoint other;
        other.go(3, right);
        other.go(1, wrong);
        CHECK(other.share() < 0.2);
        CHECK(other.largest_error < 40.0 / 800 + sag); // plus the largest effect of the wrong torque
        other.go(1, wrong);
        CHECK(other.largest_error < 3 * sag);
    }
}

} // namespace feed_forward_test
