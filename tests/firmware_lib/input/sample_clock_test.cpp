// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/core/sample_clock.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace sample_clock_test {

using namespace dfdyn;

/// Timing of a sender: its true period, and the jitter of each stamp on its grid.
struct Sender {
    double nominal_ns;
    double relative_period = 1;
    double jitter = 0; ///< maximum deviation of a stamp, early or late, in periods
    int samples = 5000;
};

double uniform(std::mt19937_64& engine, double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(engine);
}

/// Returns a sender's stamps (ns) without those of the samples in `lost`.
std::vector<std::int64_t> stamps(std::mt19937_64& engine, const Sender& sender,
                                 const std::vector<int>& lost = {}) {
    std::vector<std::int64_t> result;
    std::size_t next_lost = 0;
    for (int k = 0; k < sender.samples; ++k) {
        const double jitter = uniform(engine, -sender.jitter, sender.jitter);
        if (next_lost < lost.size() && lost[next_lost] == k) {
            ++next_lost;
            continue;
        }
        result.push_back(
            static_cast<std::int64_t>(sender.nominal_ns * (sender.relative_period * k + jitter)));
    }
    return result;
}

/// Returns the indices of the stamps before which the clock reports a loss.
std::vector<int> losses(double nominal_ns, const std::vector<std::int64_t>& stamps) {
    SampleClock clock;
    std::vector<int> result;
    for (std::size_t k = 1; k < stamps.size(); ++k) {
        if (clock.lost_before(static_cast<std::uint64_t>(stamps[k] - stamps[k - 1]),
                              static_cast<std::int64_t>(nominal_ns))) {
            result.push_back(static_cast<int>(k));
        }
    }
    return result;
}

/// Returns the indices at which a clock should report these lost samples, none of which are adjacent.
std::vector<int> expected_at(const std::vector<int>& lost) {
    std::vector<int> result;
    for (std::size_t i = 0; i < lost.size(); ++i) {
        result.push_back(lost[i] - static_cast<int>(i));
    }
    return result;
}

/// Returns samples at random distances, the first one after `first` samples.
std::vector<int> random_losses(std::mt19937_64& engine, int samples, int first, int least, int most) {
    std::vector<int> lost;
    std::uniform_int_distribution<int> distance(least, most);
    for (int k = first; k < samples - 1; k += distance(engine)) {
        lost.push_back(k);
    }
    return lost;
}

constexpr double periods_ns[] = {20e6, 8e6, 2e6, 1e6, 200e3}; // 50 Hz to 5 kHz

TEST_CASE("jitter of half a period and a nominal period wrong by some percent are not losses") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double nominal_ns : periods_ns) {
        std::size_t taken_for_losses = 0;
        for (int senders = 0; senders < 8; ++senders) {
            const Sender sender{nominal_ns, uniform(engine, 0.99, 1.03), uniform(engine, 0.3, 0.49)};
            taken_for_losses += losses(nominal_ns, stamps(engine, sender)).size();
        }
        CHECK(taken_for_losses <= 4); // of 40,000; a limit of 1.5 periods per step gives thousands
    }
}

TEST_CASE("jitter of a third of a period is never mistaken for a loss") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double nominal_ns : periods_ns) {
        const Sender sender{nominal_ns, uniform(engine, 0.99, 1.01), 0.33, 20'000};
        CHECK(losses(nominal_ns, stamps(engine, sender)).empty());
    }
}

TEST_CASE("every lost sample of a clock with little jitter is detected at once, from the second sample on") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double nominal_ns : periods_ns) {
        for (const double jitter : {0.0, 0.1}) {
            const Sender sender{nominal_ns, uniform(engine, 0.99, 1.01), jitter};
            const auto lost = random_losses(engine, sender.samples, jitter > 0 ? 30 : 1, 3, 60);
            CHECK(losses(nominal_ns, stamps(engine, sender, lost)) == expected_at(lost));
        }
    }
}

TEST_CASE("a single lost sample is detected under jitter of a quarter of a period") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double nominal_ns : periods_ns) {
        const Sender sender{nominal_ns, uniform(engine, 0.99, 1.01), 0.25, 20'000};
        const auto lost = random_losses(engine, sender.samples, 300, 150, 500);
        CHECK(losses(nominal_ns, stamps(engine, sender, lost)) == expected_at(lost));
    }
}

TEST_CASE("alternating steps of 10 and 12 ms are one grid for either nominal period") {
    for (const double nominal_ns : {10e6, 10.66e6, 11e6, 12e6}) {
        std::vector<std::int64_t> stamps{0};
        for (int k = 0; k < 1000; ++k) {
            stamps.push_back(stamps.back() + (k % 2 == 0 ? 10'000'000 : 12'000'000));
        }
        CHECK(losses(nominal_ns, stamps).empty());
        stamps.erase(stamps.begin() + 500);
        CHECK(losses(nominal_ns, stamps) == std::vector<int>{500});
    }
}

TEST_CASE("losses of a sender without a grid, which waits after each sample, are detected") {
    DFDYN_SEEDED_ENGINE(engine);
    std::vector<std::int64_t> stamps;
    double now_ns = 0;
    for (int k = 0; k < 20'000; ++k) {
        stamps.push_back(static_cast<std::int64_t>(now_ns));
        now_ns += 1e6 * uniform(engine, 0.97, 1.1);
    }
    CHECK(losses(1e6, stamps).empty());
    const auto lost = random_losses(engine, 20'000, 500, 3, 60);
    std::vector<std::int64_t> rest;
    for (int k = 0; k < 20'000; ++k) {
        if (!std::binary_search(lost.begin(), lost.end(), k)) {
            rest.push_back(stamps[static_cast<std::size_t>(k)]);
        }
    }
    CHECK(losses(1e6, rest) == expected_at(lost));
}

TEST_CASE("a clock much faster or slower than the nominal one has no gaps while steps are below "
          "one and a half periods") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double relative : {0.1, 0.5, 0.8, 1.2, 1.3, 1.4}) {
        CAPTURE(relative);
        CHECK(losses(1e6, stamps(engine, {1e6, relative})).empty());
    }
}

TEST_CASE("one sample that is late by half a period has no lasting effect") {
    std::vector<std::int64_t> stamps;
    for (int k = 0; k < 1000; ++k) {
        stamps.push_back(1'000'000 * k + (k % 100 == 50 ? 500'000 : 0));
    }
    CHECK(losses(1e6, stamps).empty());
}

TEST_CASE("after a jump of the sender's phase losses are detected") {
    std::vector<std::int64_t> stamps{0};
    for (int k = 1; k < 2000; ++k) {
        stamps.push_back(stamps.back() + (k % 300 == 0 ? 1'400'000 : 1'000'000));
    }
    CHECK(losses(1e6, stamps).empty());
    stamps.erase(stamps.begin() + 1203);
    CHECK(losses(1e6, stamps) == std::vector<int>{1203});
}

TEST_CASE("the period is estimated from the stamps") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double relative : {0.95, 1.0, 1.07}) {
        SampleClock clock;
        const auto times = stamps(engine, {1e6, relative, 0.2});
        for (std::size_t k = 1; k < times.size(); ++k) {
            clock.lost_before(static_cast<std::uint64_t>(times[k] - times[k - 1]), 1'000'000);
        }
        CHECK(clock.relative_period() == Approx(relative).epsilon(1e-3));
        clock.restart();
        CHECK(clock.relative_period() == 1);
    }
}

TEST_CASE("steps of any length are handled") {
    constexpr auto longest = std::numeric_limits<std::uint64_t>::max();
    for (const std::int64_t period_ns : {std::int64_t{1}, std::int64_t{200'000}, std::int64_t{1} << 62}) {
        SampleClock clock;
        for (const std::uint64_t step_ns : {std::uint64_t{1}, longest, std::uint64_t{1}, longest}) {
            const bool expected = static_cast<double>(step_ns) > 1.95 * static_cast<double>(period_ns);
            CHECK(clock.lost_before(step_ns, period_ns) == expected);
        }
    }
}

} // namespace sample_clock_test
