// SPDX-License-Identifier: Apache-2.0
// How a feed-forward chooses among several forecasts, known and unknown.
#include "dfdyn/control/learner_pair.hpp"
#include "tests/firmware_lib/feed_forward/scripted_learner.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace feed_forward_pair_test {

using namespace dfdyn;
using namespace dfdyn::tests::scripted;

/// Two learners in a loop whose final command is 50 N·m, with a nominal torque of 10 N·m.
struct PairRun {
    using Pair = LearnerPair<ScriptedLearner, ScriptedLearner>;

    ScriptedLearner first, second;
    Pair pair{first, second};
    FeedForward<Pair> forward{pair, {period_ns, ticks_per_sample, {{100}}, {{90}}, {{2000}}}};
    double last = 0;
    double largest_step = 0;
    double least = 0; ///< torque of the last call of `go`

    PairRun() {
        constexpr double start = 0;
        forward.begin(0, &start);
    }

    /// The learners: first the one that a test lets the feed-forward use, which forecasts 50 N·m.
    std::array<ScriptedLearner*, 2> used_and_other(bool first_is_used) {
        ScriptedLearner* const used = first_is_used ? &first : &second;
        used->forecast = 50;
        return {used, first_is_used ? &second : &first};
    }

    void go(double seconds) {
        largest_step = 0;
        least = 100;
        for (auto tick = std::llround(seconds / period_s); tick > 0; --tick) {
            constexpr double nominal = 10;
            constexpr double needed = 50;
            const double torque = forward.update({}, &nominal)[0];
            forward.commanded(&needed);
            forward.measured(0, &nominal, &needed);
            largest_step = std::max(largest_step, std::abs(torque - last));
            least = std::min(least, torque);
            last = torque;
        }
    }
};

TEST_CASE("of two learners the more accurate one is used, and they are exchanged without a step") {
    PairRun run;
    run.first.forecast = 50;
    run.second.forecast = -30;
    run.go(3);
    CHECK(run.last == Approx(50).margin(0.1));
    CHECK(run.first.learned.size() == run.second.learned.size());
    run.first.forecast = -30;
    run.second.forecast = 50;
    run.go(0.1); // the step of the forecast itself
    run.go(6);
    CHECK(run.last == Approx(50).margin(0.1));
    CHECK(run.largest_step <= 2 * 80 * period_s / 0.2); // both the share and the mixture change
}

TEST_CASE("a missing forecast is replaced at once by the other learner's if that was accurate") {
    for (const bool first_is_used : {true, false}) {
        PairRun run;
        const auto [used, other] = run.used_and_other(first_is_used);
        other->forecast = 52; // right, too; the nominal torque has an error of 40 N·m
        run.go(3);
        other->forecast = 50;
        used->knows = false;
        run.go(0.02);
        CHECK(run.last == Approx(50).margin(0.5));
        other->knows = false;
        run.go(1);
        CHECK(run.last == Approx(10));
    }
}

TEST_CASE("a rejected forecast does not replace an unknown one") {
    for (const bool first_is_used : {true, false}) {
        PairRun run;
        const auto [used, other] = run.used_and_other(first_is_used);
        other->forecast = -30; // an error of 80 N·m; the nominal torque, 10 N·m, has one of 40
        run.go(3);
        used->knows = false;
        run.go(1);
        CHECK(run.least >= 9);
    }
}

TEST_CASE("an absurd forecast moves a joint no further than a forecast at its torque limit") {
    const auto farthest = [](double absurd) {
        PairRun run;
        run.first.forecast = 49; // an error of 1 N·m
        run.second.forecast = -30;
        run.go(3);
        run.second.forecast = absurd;
        run.go(0.05);
        return run.least;
    };
    CHECK(farthest(-1e10) == Approx(farthest(-100)).margin(1e-9));
    CHECK(farthest(-1e10) > 48.9);
}

TEST_CASE("learners with different numbers of forecasts form a pair, and unknown forecasts are NaN") {
    ScriptedLearner first, second, third;
    using Two = LearnerPair<ScriptedLearner, ScriptedLearner>;
    Two two(first, second);
    LearnerPair<Two, ScriptedLearner> three(two, third);
    LearnerPair<ScriptedLearner, Two> reversed(third, two);
    first.forecast = 1;
    second.forecast = 2;
    third.forecast = 3;
    constexpr double position = 0;
    std::array<double, 4> torque{0, 0, 0, -7}; // the last value is not a forecast
    constexpr double unknown = -1;             // stands for NaN, which equals nothing
    const auto predicted = [&](auto& pair) {
        CHECK(pair.predict(0, &position, torque.data()));
        std::ranges::replace_if(
            torque, [](double value) { return std::isnan(value); }, unknown);
        return torque;
    };
    CHECK(predicted(three) == std::array<double, 4>{1, 2, 3, -7});
    CHECK(predicted(reversed) == std::array<double, 4>{3, 1, 2, -7});
    third.knows = false;
    CHECK(predicted(three) == std::array<double, 4>{1, 2, unknown, -7});
    CHECK(predicted(reversed) == std::array<double, 4>{unknown, 1, 2, -7});
    third.knows = true;
    first.knows = second.knows = false;
    CHECK(predicted(three) == std::array<double, 4>{unknown, unknown, 3, -7});
    CHECK(predicted(reversed) == std::array<double, 4>{3, unknown, unknown, -7});
}

TEST_CASE("a learner gains no weight while it has no prediction") {
    PairRun run;
    run.first.forecast = 50;
    run.second.knows = false;
    run.go(3);
    run.second.knows = true;
    run.second.forecast = -30;
    run.go(0.05);
    CHECK(run.last == Approx(50).margin(1)); // with equal shares it would be 10
}

TEST_CASE("a wrong learner gains no share while another one has no prediction") {
    PairRun run;
    run.first.forecast = -30; // an error of 80 N·m; the nominal torque has an error of 40
    run.second.knows = false;
    run.go(3);
    CHECK(run.forward.share()[0] < 0.1);
}

TEST_CASE("other forecasts are combined with the command's shares, without unknown ones") {
    PairRun run;
    run.first.forecast = 50;
    run.second.forecast = -30;
    run.go(3);
    const auto combined = [&](double first, double second) {
        const std::array<double, 2> other{first, second};
        constexpr double nominal = 20;
        double torque = 0;
        run.forward.combine(other.data(), &nominal, &torque);
        return torque;
    };
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    CHECK(combined(7, 1000) == Approx(7).margin(0.1));
    CHECK(combined(7, unknown) == Approx(7).margin(0.1));
    CHECK(combined(unknown, -80) == 20); // it was worse than the nominal torque
    CHECK(combined(unknown, unknown) == 20);
    constexpr double start = 0;
    run.forward.begin(0, &start);
    CHECK(combined(7, 7) == 20); // no forecast has a share yet
}

} // namespace feed_forward_pair_test
