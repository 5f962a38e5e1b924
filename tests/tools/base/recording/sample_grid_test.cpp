// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/sample_grid.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/base/text/error.hpp"

#include <algorithm>
#include <vector>

namespace sample_grid_test {

using namespace dfdyn::tools;

/// A recording in which only the time stamps matter.
Recording with_stamps(std::vector<std::int64_t> stamps_ns) {
    Recording recording;
    recording.source = "run.csv";
    recording.time_ns = std::move(stamps_ns);
    recording.gap_before.assign(recording.time_ns.size(), 0);
    recording.gap_before.front() = 1;
    return recording;
}

std::vector<std::int64_t> repeated_steps(const std::vector<std::int64_t>& steps_ns, int rows) {
    std::vector<std::int64_t> stamps{0};
    for (int row = 1; row < rows; ++row) {
        stamps.push_back(stamps.back() + steps_ns[static_cast<std::size_t>(row - 1) % steps_ns.size()]);
    }
    return stamps;
}

long restarts(const Recording& recording) {
    const auto flags = window_restarts(recording, sample_period_s({&recording, 1}));
    return std::count(flags.begin(), flags.end(), 1);
}

TEST_CASE("the period of a steady clock is exact even with lost samples") {
    for (const std::int64_t period_ns : {20'000'000, 8'000'000, 1'000'000, 200'000}) {
        auto stamps = repeated_steps({period_ns}, 1000);
        for (const int lost : {900, 500, 499, 200}) {
            stamps.erase(stamps.begin() + lost);
        }
        const Recording recording = with_stamps(stamps);
        CHECK(sample_period_s({&recording, 1}) ==
              Approx(1e-9 * static_cast<double>(period_ns)).epsilon(1e-12));
        CHECK(restarts(recording) == 1 + 3);
    }
}

TEST_CASE("the period of uneven steps is their mean and none of them is a gap") {
    constexpr std::int64_t ms = 1'000'000;
    const Recording in_turn = with_stamps(repeated_steps({10 * ms, 12 * ms}, 1001));
    CHECK(sample_period_s({&in_turn, 1}) == Approx(0.011));
    CHECK(restarts(in_turn) == 1);
    const Recording thirds = with_stamps(repeated_steps({10 * ms, 10 * ms, 12 * ms}, 1000));
    CHECK(sample_period_s({&thirds, 1}) == Approx(0.032 / 3));
    CHECK(restarts(thirds) == 1);
}

TEST_CASE("jitter of nearly half a period changes neither the period nor the windows") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_real_distribution<double> jitter(-0.4, 0.4);
    std::vector<std::int64_t> stamps;
    for (int row = 0; row < 4000; ++row) {
        stamps.push_back(static_cast<std::int64_t>(1e6 * (row + jitter(engine))));
    }
    const Recording recording = with_stamps(stamps);
    CHECK(sample_period_s({&recording, 1}) == Approx(0.001).epsilon(0.01));
    CHECK(restarts(recording) == 1);
}

TEST_CASE("a window restarts where the recording has a gap") {
    Recording recording = with_stamps(repeated_steps({1'000'000}, 100));
    recording.gap_before[40] = 1;
    const auto flags = window_restarts(recording, 0.001);
    CHECK(std::count(flags.begin(), flags.end(), 1) == 2);
    CHECK(flags[40] == 1);
}

TEST_CASE("the stride with constant steps is found in a recording of pairs and in no random one") {
    const Recording pairs = with_stamps(repeated_steps({8'000'000, 24'000'000}, 1000));
    const SteadyStride stride = steady_stride({&pairs, 1});
    CHECK(stride.rows == 2);
    CHECK(stride.period_s == 0.032);
    const Recording triples = with_stamps(repeated_steps({8'000'000, 8'000'000, 30'000'000}, 1000));
    CHECK(steady_stride({&triples, 1}).rows == 3);
    DFDYN_SEEDED_ENGINE(engine);
    std::vector<std::int64_t> stamps{0};
    std::uniform_int_distribution<int> lost(0, 3);
    while (stamps.size() < 1000) {
        stamps.push_back(stamps.back() + 8'000'000 * (1 + 2 * lost(engine)));
    }
    const Recording random = with_stamps(stamps);
    CHECK(steady_stride({&random, 1}).rows == 0);
}

TEST_CASE("a recording of one row has no period") {
    const Recording recording = with_stamps({5});
    CHECK_THROWS_MATCHES(
        sample_period_s({&recording, 1}), InputError,
        Catch::Matchers::Message("run.csv: expected at least two rows to train on, found one"));
}

TEST_CASE("recordings whose periods differ by more than an eighth have none in common") {
    constexpr std::int64_t ms = 1'000'000;
    std::vector<Recording> recordings{with_stamps(repeated_steps({8 * ms}, 1000)),
                                      with_stamps(repeated_steps({9 * ms}, 500))};
    CHECK(sample_period_s(recordings) == Approx(0.008).epsilon(0.1));
    recordings.back() = with_stamps(repeated_steps({2 * ms}, 500));
    recordings.back().source = "fast.csv";
    CHECK_THROWS_MATCHES(sample_period_s(recordings), InputError,
                         Catch::Matchers::Message("fast.csv: expected a row every 0.008 s, as in run.csv, "
                                                  "found one every 0.002 s"));
}

TEST_CASE("rows closer than a model's sample period are refused, rows farther apart are not") {
    const Recording recording = with_stamps(repeated_steps({2'000'000}, 500));
    CHECK_NOTHROW(check_not_faster(recording, 0.001, "m.json"));
    CHECK_NOTHROW(check_not_faster(recording, 0.0022, "m.json"));
    CHECK_THROWS_MATCHES(check_not_faster(recording, 0.008, "m.json"), InputError,
                         Catch::Matchers::Message("run.csv: expected a row every 0.008 s, as in the training "
                                                  "of m.json, found one every 0.002 s"));
    CHECK_NOTHROW(check_not_faster(with_stamps({5}), 0.001, "m.json"));
    CHECK_NOTHROW(check_period(recording, 0.0022, "m.json"));
    CHECK_THROWS_AS(check_period(recording, 0.008, "m.json"), InputError);
    CHECK_THROWS_MATCHES(check_period(recording, 0.001, "m.json"), InputError,
                         Catch::Matchers::Message(recording.source +
                                                  ": expected a row every 0.001 s, as in the "
                                                  "training of m.json, found one every 0.002 s"));
    CHECK_NOTHROW(check_period(with_stamps({5}), 0.001, "m.json"));
}

} // namespace sample_grid_test
