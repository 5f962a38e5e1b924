// SPDX-License-Identifier: Apache-2.0
// Time stamps of valid samples: jitter, a wrong nominal period, lost samples.
#include "dfdyn/estimator.hpp"

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

namespace estimator_clock_test {

using namespace dfdyn;
using namespace dfdyn::tests;

using SmallModel = TestModel<float>;
constexpr int lags = SmallModel::Input::lags;

struct Line {
    std::int64_t period_ns;
    double relative_period;
    double jitter;
};

/// Counts the reasons of `ticks` ticks over that line. Every sample whose number is a multiple of `loses` is
/// lost.
Counters run(const Line& line, int ticks, std::mt19937_64& engine, int loses = 0) {
    auto constants = make_constants<SmallModel>(engine);
    constants.period_ns = line.period_ns;
    constants.gap_ns = 3 * line.period_ns / 2;
    Estimator<SmallModel> estimator(constants);
    std::uniform_real_distribution<double> jitter(-line.jitter, line.jitter);
    for (int t = 1; t <= ticks; ++t) {
        auto sample = moving_sample<SmallModel>(t, engine);
        const double place = line.relative_period * t + jitter(engine);
        sample.time_ns = static_cast<std::int64_t>(place * static_cast<double>(line.period_ns));
        if (loses == 0 || t % loses != 0) {
            estimator.tick(sample, Budget::unlimited());
        }
    }
    return estimator.counters();
}

TEST_CASE("with jitter of nearly half a period every tick predicts once the window is full") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const std::int64_t period_ns : {20'000'000, 8'000'000, 1'000'000, 200'000}) {
        const Line line{period_ns, 1.01, 0.4};
        CHECK(run(line, 3000, engine).predicted == 3000 - lags);
    }
}

TEST_CASE("a lost sample restarts the window, also with jitter of a tenth of a period") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double jitter : {0.0, 0.1}) {
        const Counters counters = run({1'000'000, 1.01, jitter}, 3000, engine, 100);
        CHECK(counters.reasons[static_cast<int>(Reason::gap)] == 29); // no sample follows the last loss
        CHECK(counters.predicted == 3000 - 30 - 30 * lags);
    }
}

TEST_CASE("without a sample period, a step is a gap if and only if it exceeds the gap time") {
    DFDYN_SEEDED_ENGINE(engine);
    auto constants = make_constants<SmallModel>(engine);
    constants.period_ns = 0;
    constants.gap_ns = 1500;
    Estimator<SmallModel> estimator(constants);
    auto sample = moving_sample<SmallModel>(0, engine);
    const auto after = [&](std::int64_t step_ns) {
        sample.time_ns += step_ns;
        return estimator.tick(sample, Budget::unlimited()).status.reason();
    };
    after(1);
    for (int repeat = 0; repeat < 3; ++repeat) {
        CHECK(after(1500) == Reason::window_filling);
        CHECK(after(1501) == Reason::gap);
    }
}

} // namespace estimator_clock_test
