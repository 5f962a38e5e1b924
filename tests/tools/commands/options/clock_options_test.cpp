// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/clock_options.hpp"

#include "tests/support/catch.hpp"
#include "tools/base/text/error.hpp"

#include <cmath>

namespace clock_options_test {

using namespace dfdyn::tools;

TrainingOptions applied(const ClockOptions& clock, double period_s, InputKind input = InputKind::DFR) {
    TrainingOptions options;
    options.input = input;
    clock.apply(options, period_s);
    return options;
}

TEST_CASE("the default window has the same duration at any sample rate") {
    for (const double period_s : {0.02, 0.011, 0.008, 0.002, 0.001, 0.0002}) {
        const TrainingOptions options = applied({}, period_s);
        CHECK(period_s * options.lags * options.every == Approx(0.08).margin(0.6 * period_s));
        CHECK(options.lags <= 20);
    }
    CHECK(applied({}, 0.008).lags == 10);
    CHECK(applied({}, 0.008).every == 1);
}

TEST_CASE("a memory in seconds has the same duration at any sample rate") {
    ClockOptions clock;
    clock.memory_s = 10;
    for (const double period_s : {0.02, 0.008, 0.001, 0.0002}) {
        const double samples = 10 / period_s;
        CHECK(std::pow(applied(clock, period_s).forgetting_factor, samples) == Approx(std::exp(-1)));
    }
}

TEST_CASE("lags and forgetting in samples are used unchanged") {
    ClockOptions clock;
    clock.lags = 30;
    clock.forgetting_factor = 0.9999;
    const TrainingOptions options = applied(clock, 0.0002);
    CHECK(options.lags == 30);
    CHECK(options.every == 1);
    CHECK(options.forgetting_factor == 0.9999);
}

TEST_CASE("a given spacing sets the lags of a window") {
    ClockOptions clock;
    clock.window_s = 0.1;
    clock.every = 5;
    CHECK(applied(clock, 0.001).lags == 20);
    CHECK(applied(clock, 0.001).every == 5);
}

TEST_CASE("window and memory are described in seconds") {
    ClockOptions clock;
    CHECK(describe_clock(applied(clock, 0.008), 0.008) ==
          "sample period 0.008 s, window 0.08 s (10 lags, 1 sample apart), memory unlimited");
    clock.memory_s = 20;
    CHECK(describe_clock(applied(clock, 0.0002), 0.0002) ==
          "sample period 0.0002 s, window 0.08 s (20 lags, 20 samples apart), memory 20 s");
}

TEST_CASE("a memory that single precision changes is described as the model has it") {
    ClockOptions clock;
    clock.memory_s = 7200;
    CHECK_THAT(describe_clock(applied(clock, 0.0002), 0.0002),
               Catch::Matchers::EndsWith(", memory unlimited (7200 s rounded to single precision)"));
    clock.memory_s = 2000;
    CHECK_THAT(describe_clock(applied(clock, 0.0002), 0.0002),
               Catch::Matchers::EndsWith(", memory 1678 s (2000 s rounded to single precision)"));
}

TEST_CASE("input STD has lags of one sample") {
    CHECK(applied({}, 0.001, InputKind::STD).every == 1);
    CHECK(applied({}, 0.001, InputKind::STD).lags == 80);
}

TEST_CASE("a window with more samples than a model can have is rejected") {
    ClockOptions clock;
    clock.window_s = 0.3;
    CHECK_THROWS_WITH(applied(clock, 0.0002),
                      "--window: expected at most 1000 sample periods, 0.2 s, found 0.3 s");
}

TEST_CASE("a memory of fewer samples than weights is rejected in seconds") {
    ClockOptions clock;
    clock.memory_s = 0.1;
    TrainingOptions options; // 250 features
    CHECK_THROWS_WITH(clock.apply(options, 0.008),
                      "--memory: expected at least 4 s (2 samples per feature at 125 Hz), found 0.1 s");
    CHECK_THROWS_WITH(clock.apply(options, 0.008, true), // a budget chooses fewer features
                      "--memory: expected at least 0.16 s (2 samples per feature at 125 Hz, with 10 "
                      "features), found 0.1 s");
    clock.memory_s = 0.16;
    CHECK_NOTHROW(clock.apply(options, 0.008, true));
    clock.memory_s = 0.1;
    options.model = &structures::P;
    CHECK_NOTHROW(clock.apply(options, 0.008));
    clock.memory_s = 0.01;
    CHECK_THROWS_WITH(clock.apply(options, 0.008),
                      "--memory: expected at least 0.016 s (2 samples at 125 Hz), found 0.01 s");
    clock.memory_s = 4;
    options.model = &structures::NP;
    CHECK_NOTHROW(clock.apply(options, 0.008));
}

} // namespace clock_options_test
