// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/result/error_curve.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/experiment/synthetic_jobs.hpp"
#include "tools/base/numerics/quantile.hpp"
#include "tools/experiment/result/phase_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace error_curve_test {

using namespace dfdyn::tools;
using dfdyn::tests::job_at;

const double infinite = std::numeric_limits<double>::infinity();

/// Three draws with gaps: no subset begins before tick 2, one ends early, and one value is infinite.
std::vector<JobResult> draws_with_gaps(std::mt19937_64& engine) {
    std::vector<JobResult> draws;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        draws.push_back(job_at("A", seed, 1, engine));
        for (std::vector<double>& subset : draws.back().error[1]) {
            subset[0] = subset[1] = std::nan("");
        }
        draws.back().error[1][2].resize(40);
        draws.back().error[1][0][7] = infinite;
    }
    return draws;
}

std::vector<const JobResult*> pointers(const std::vector<JobResult>& draws) {
    std::vector<const JobResult*> all;
    std::ranges::transform(draws, std::back_inserter(all), [](const JobResult& draw) { return &draw; });
    return all;
}

/// The mean over the subsets of one draw, computed explicitly.
double draw_mean(const JobResult& draw, std::size_t tick) {
    double sum = 0;
    int count = 0;
    for (std::size_t subset = 0; subset < 3; ++subset) {
        const std::vector<double>& error = draw.error[1][subset];
        const bool there = tick < error.size() && !std::isnan(error[tick]);
        sum += there ? error[tick] : 0;
        count += there ? 1 : 0;
    }
    return sum / count;
}

TEST_CASE("the curve is the mean over subsets and then over draws with the quartiles of the draws") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<JobResult> draws = draws_with_gaps(engine);
    const ErrorCurve curve = error_curve(pointers(draws), 1);
    REQUIRE(curve.time_s.size() == 60);
    CHECK(std::isnan(curve.mean[0]));
    CHECK(std::isnan(curve.mean[1]));
    for (std::size_t tick = 2; tick < 60; ++tick) {
        if (tick == 7) { // lost
            CHECK(curve.mean[tick] == infinite);
            continue;
        }
        const double a = draw_mean(draws[0], tick);
        const double b = draw_mean(draws[1], tick);
        const double c = draw_mean(draws[2], tick);
        CHECK(curve.time_s[tick] == Approx(0.1 * static_cast<double>(tick)));
        CHECK(curve.mean[tick] == Approx((a + b + c) / 3));
        const double middle = a + b + c - std::min({a, b, c}) - std::max({a, b, c});
        CHECK(curve.low[tick] == Approx((std::min({a, b, c}) + middle) / 2));
        CHECK(curve.high[tick] == Approx((std::max({a, b, c}) + middle) / 2));
    }
}

TEST_CASE("a thinned curve averages each interval of its logarithmic axis once") {
    ErrorCurve curve;
    for (int tick = 0; tick < 1000; ++tick) {
        curve.time_s.push_back(0.1 * tick);
        const double value = tick < 5 ? std::nan("") : 1.0 + tick;
        curve.mean.push_back(value);
        curve.low.push_back(0.5 * value);
        curve.high.push_back(2 * value);
    }
    const ErrorCurve thin = thinned(curve, 10);
    CHECK(thin.time_s.size() <= 10 * 3);
    CHECK(thin.time_s.front() == Approx(0.5));
    CHECK(std::ranges::is_sorted(thin.time_s));
    for (std::size_t i = 0; i < thin.time_s.size(); ++i) {
        // The mean over a straight line is its value at the mean time.
        CHECK(thin.mean[i] == Approx(1 + 10 * thin.time_s[i]));
        CHECK(thin.low[i] == Approx(0.5 * thin.mean[i]));
        CHECK(thin.high[i] == Approx(2 * thin.mean[i]));
    }
    CHECK(thin.time_s.back() > 80);
    curve.mean[10] = infinite; // t = 1
    const auto lost = std::ranges::count(thinned(curve, 10).mean, infinite);
    CHECK(lost == 1); // interrupts the line instead of looking like a better point
}

TEST_CASE("the transient and the steady phase are separated at the settling time") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<JobResult> draws = draws_with_gaps(engine);
    const JobResult& draw = draws.front();
    const std::vector<double> transient = errors_of_phase(draw, 1, 0, Phase::transient, 2);
    const std::vector<double> steady = errors_of_phase(draw, 1, 0, Phase::steady, 2);
    CHECK(transient.size() == 18); // ticks 2 … 19
    CHECK(steady.size() == 40);
    CHECK(steady.front() == draw.error[1][0][20]);
    CHECK(phase_error(draw, 1, 0, Phase::steady, 2) == Approx(median(steady)));
    CHECK(phase_error(draw, 1, 0, Phase::transient, 2) == infinite);
    CHECK(phase_error(draw, 1, 1, Phase::transient, 2) ==
          Approx(mean_of(errors_of_phase(draw, 1, 1, Phase::transient, 2))));
    CHECK(lost_share(pointers(draws), 1) == Approx(1.0 / (58 + 58 + 38)));
    CHECK(lost_share(pointers(draws), 0) == 0);
    CHECK(phase_box(pointers(draws), 1, Phase::steady, 2).count == 3 * (40 + 40 + 20));
}

} // namespace error_curve_test
