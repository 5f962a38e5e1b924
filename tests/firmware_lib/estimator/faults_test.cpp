// SPDX-License-Identifier: Apache-2.0
// Single faults of the sensors, the bus or the clock.
#include "dfdyn/estimator.hpp"

#include "tests/firmware_lib/support/running_arm.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <limits>

namespace estimator_faults_test {

using namespace dfdyn;
using namespace dfdyn::tests;

using SmallModel = TestModel<double>;
constexpr int lags = SmallModel::Input::lags;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Arm : RunningArm<SmallModel> {
    explicit Arm(std::mt19937_64& engine) : RunningArm(engine, make_constants<SmallModel>(engine)) {}
};

SmallModel::Sample with_position(SmallModel::Sample sample, int joint, double position) {
    sample.position[joint] = position;
    return sample;
}

SmallModel::Sample with_output(SmallModel::Sample sample, int output, double value) {
    sample.output[output] = value;
    return sample;
}

SmallModel::Sample with_time(SmallModel::Sample sample, std::int64_t time_ns) {
    sample.time_ns = time_ns;
    return sample;
}

TEST_CASE("a position that is NaN or beyond its limit is refused and leaves a gap") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    for (const int joint : {0, 1}) {
        for (const double bad : {not_a_number, infinity, -infinity}) {
            CHECK(arm.refused(with_position(arm.due(), joint, bad)) == Reason::position_not_finite);
            CHECK(arm.refused(arm.due()) == Reason::gap);
            CHECK(arm.ticks_to_recover() == lags - 1);
        }
        for (const double bad : {10.001, -10.001, 1e300, -1e300}) {
            CHECK(arm.refused(with_position(arm.due(), joint, bad)) == Reason::position_out_of_range);
            CHECK(arm.refused(arm.due()) == Reason::gap);
            CHECK(arm.ticks_to_recover() == lags - 1);
        }
    }
}

TEST_CASE("a limit that is NaN refuses every value") {
    DFDYN_SEEDED_ENGINE(engine);
    auto constants = make_constants<SmallModel>(engine);
    constants.output_limit[0] = not_a_number;
    RunningArm<SmallModel> unlearned(engine, constants);
    const auto estimate = unlearned.estimator.tick(unlearned.due(), Budget::unlimited());
    CHECK(estimate.status.learning == Reason::output_out_of_range);
    constants.position_limit[1] = not_a_number;
    RunningArm<SmallModel> still(engine, constants);
    CHECK(still.refused(still.due()) == Reason::position_out_of_range);
}

TEST_CASE("a refused position with the stamp of a valid one has no effect") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    const auto good = arm.due();
    CHECK(arm.refused(with_position(good, 1, not_a_number)) == Reason::position_not_finite);
    CHECK(arm.tick(good) == Reason::ok);
}

TEST_CASE("a position at its limit is accepted") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    for (const double limit : {10.0, -10.0}) {
        arm.estimator.restart_window();
        CHECK(arm.tick(with_position(arm.due(), 0, limit)) == Reason::window_filling);
    }
}

TEST_CASE("an output that is NaN or beyond its limit is predicted and not learned") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    for (const int output : {0, 1}) {
        for (const double bad : {not_a_number, infinity, -infinity}) {
            CHECK(arm.refused(with_output(arm.due(), output, bad)) == Reason::output_not_finite);
        }
        for (const double bad : {100.001, -100.001, 1e300}) {
            const auto before = arm.estimator.counters().predicted;
            CHECK(arm.refused(with_output(arm.due(), output, bad)) == Reason::output_out_of_range);
            CHECK(arm.estimator.counters().predicted == before + 1);
        }
        CHECK(arm.tick(with_output(arm.due(), output, 100)) == Reason::ok);
    }
    const auto estimate = arm.estimator.tick(with_output(arm.due(), 0, not_a_number), Budget::unlimited());
    CHECK(estimate.innovation[0] == 0);
    CHECK(estimate.normalised_innovation_squared == 0);
    CHECK(std::isfinite(estimate.standard_deviation[0]));
}

TEST_CASE("a missing output may contain any value") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    auto sample = with_output(arm.due(), 0, not_a_number);
    sample.output_valid = false;
    CHECK(arm.refused(sample) == Reason::output_missing);
}

TEST_CASE("a repeated or an old sample is refused and the window stays") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    const auto good = arm.due();
    CHECK(arm.tick(good) == Reason::ok);
    for (int repeats = 0; repeats < 10; ++repeats) {
        CHECK(arm.refused(good) == Reason::time_not_increasing);
    }
    CHECK(arm.tick(arm.due()) == Reason::ok);
    for (int strays = 0; strays < 10; ++strays) {
        CHECK(arm.refused(with_time(good, good.time_ns - 1)) == Reason::time_not_increasing);
        CHECK(arm.refused(with_time(good, good.time_ns - 1'000'000'000)) == Reason::time_not_increasing);
        CHECK(arm.tick(arm.due()) == Reason::ok);
    }
}

TEST_CASE("old samples with a repeated stamp in between are not a new clock") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    const auto last = arm.due();
    CHECK(arm.tick(last) == Reason::ok);
    const auto stray = with_time(last, last.time_ns - 5);
    for (const auto& sample : {stray, stray, last, stray, stray}) {
        CHECK(arm.refused(sample) == Reason::time_not_increasing);
    }
    CHECK(arm.tick(arm.due()) == Reason::ok);
}

TEST_CASE("a clock that was set back is adopted at the third sample and the window fills again") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    arm.clock_offset_ns = -1'000'000'000;
    CHECK(arm.refused(arm.due()) == Reason::time_not_increasing);
    CHECK(arm.refused(arm.due()) == Reason::time_not_increasing);
    CHECK(arm.refused(arm.due()) == Reason::clock_restarted);
    for (int t = 1; t < lags; ++t) {
        CHECK(arm.refused(arm.due()) == Reason::window_filling);
    }
    CHECK(arm.tick(arm.due()) == Reason::ok);
}

TEST_CASE("a gap restarts the window and a late sample does not") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    CHECK(arm.tick(arm.due()) == Reason::ok);
    const std::int64_t gap_ns = arm.constants.gap_ns;
    auto late = arm.due();
    const std::int64_t last_ns = late.time_ns - period_ns;
    late.time_ns = last_ns + gap_ns;
    CHECK(arm.tick(late) == Reason::ok);
    arm.clock_offset_ns = late.time_ns + gap_ns + 1 - arm.now * period_ns;
    CHECK(arm.refused(arm.due()) == Reason::gap);
    CHECK(arm.ticks_to_recover() == lags - 1);
}

TEST_CASE("a gap while the window fills restarts it") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    for (int gaps = 0; gaps < 3; ++gaps) {
        arm.due();
        CHECK(arm.refused(arm.due()) == Reason::gap);
        CHECK(arm.refused(arm.due()) == Reason::window_filling);
    }
    CHECK(arm.ticks_to_recover() == lags - 2);
}

TEST_CASE("after one stamp far in the future the true clock is adopted again") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    CHECK(arm.refused(with_time(arm.due(), std::numeric_limits<std::int64_t>::max())) == Reason::gap);
    CHECK(arm.refused(arm.due()) == Reason::time_not_increasing);
    CHECK(arm.refused(arm.due()) == Reason::time_not_increasing);
    CHECK(arm.refused(arm.due()) == Reason::clock_restarted);
    CHECK(arm.ticks_to_recover() == lags - 1);
}

TEST_CASE("a clock may jump by its whole range") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    constexpr std::int64_t first = std::numeric_limits<std::int64_t>::min();
    CHECK(arm.refused(with_time(arm.due(), first)) == Reason::time_not_increasing);
    CHECK(arm.refused(with_time(arm.due(), first)) == Reason::time_not_increasing);
    CHECK(arm.refused(with_time(arm.due(), first)) == Reason::clock_restarted);
    CHECK(arm.refused(arm.due()) == Reason::gap);
    CHECK(arm.ticks_to_recover() == lags - 1);
}

TEST_CASE("an encoder jump is refused while it makes the inputs invalid") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    CHECK(arm.refused(with_position(arm.due(), 0, -9.9)) == Reason::input_out_of_range);
    CHECK(arm.refused(arm.due()) == Reason::input_out_of_range);
    for (int t = 0; t < lags; ++t) {
        arm.tick(arm.due()); // the jump leaves the window
    }
    CHECK(arm.tick(arm.due()) == Reason::ok);
}

TEST_CASE("an arm whose sensors all read zero is learned without faults") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm(engine);
    SmallModel::Sample zeros{};
    zeros.output_valid = true;
    for (int t = 0; t < 5000; ++t) {
        zeros.time_ns = (arm.now + 10 + t) * period_ns;
        const auto estimate = arm.estimator.tick(zeros, Budget::unlimited());
        if (t >= lags) {
            REQUIRE(estimate.status.learned());
            REQUIRE(std::isfinite(estimate.prediction[0]));
            REQUIRE(std::isfinite(estimate.standard_deviation[1]));
        }
    }
    const auto last =
        arm.estimator.tick({(arm.now + 5010) * period_ns, {{0, 0}}, {{0, 0}}, true}, Budget::unlimited());
    CHECK(std::abs(last.prediction[0]) < 0.01);
}

TEST_CASE("an output whose square overflows is out of range for any limit") {
    DFDYN_SEEDED_ENGINE(engine);
    auto constants = make_constants<SmallModel>(engine);
    constants.output_limit = {{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()}};
    RunningArm<SmallModel> arm(engine, constants);
    CHECK(arm.refused(with_output(arm.due(), 0, 1e200)) == Reason::output_out_of_range);
    CHECK(arm.tick(arm.due()) == Reason::ok);
}

TEST_CASE("a clock may change sign in a gap and within a window") {
    DFDYN_SEEDED_ENGINE(engine);
    using Timed = TestModel<double, Standard<6>>;
    RunningArm<Timed> arm(engine, make_constants<Timed>(engine));
    arm.clock_offset_ns = -(arm.now + 5) * period_ns - 1'000'000'000;
    arm.estimator.restart_window();
    CHECK(arm.ticks_to_recover() == 6);
    arm.clock_offset_ns = -(arm.now + 3) * period_ns;
    CHECK(arm.refused(arm.due()) == Reason::gap);
    CHECK(arm.ticks_to_recover() == 5);
    CHECK(arm.tick(arm.due()) == Reason::ok);
}

TEST_CASE("samples with measured derivatives that are NaN or too large are refused") {
    DFDYN_SEEDED_ENGINE(engine);
    using Measured = TestModel<double, StandardMeasured>;
    RunningArm<Measured> arm(engine, make_constants<Measured>(engine));
    for (const double bad : {not_a_number, infinity, 1e9}) {
        auto sample = arm.due();
        sample.velocity[1] = bad;
        CHECK(arm.refused(sample) == Reason::input_out_of_range);
        CHECK(arm.tick(arm.due()) == Reason::ok);
        sample = arm.due();
        sample.acceleration[0] = bad;
        CHECK(arm.refused(sample) == Reason::input_out_of_range);
        CHECK(arm.tick(arm.due()) == Reason::ok);
    }
}

} // namespace estimator_faults_test
