// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/monitor/false_alarm_threshold.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

namespace excursion_tail_test {

using namespace dfdyn;

/// A sum of random steps with a drift of -1 and several distributions; provides the heights of its
/// excursions.
class Walk {
  public:
    explicit Walk(int kind) : kind_(kind) {}

    /// Performs one step; returns the height of an excursion that ended, or 0.
    double step(std::mt19937_64& engine) {
        sum_ += draw(engine) - 1;
        if (sum_ > 0) {
            peak_ = std::max(peak_, sum_);
            return 0;
        }
        sum_ = 0;
        return std::exchange(peak_, 0);
    }

  private:
    double draw(std::mt19937_64& engine) {
        if (kind_ == 0) {
            return 2 * std::normal_distribution<double>()(engine);
        }
        if (kind_ == 1) { // skewed
            return std::exponential_distribution<double>()(engine) - 1;
        }
        slow_ = 0.7 * slow_ + 0.6 * std::normal_distribution<double>()(engine); // coloured
        return slow_;
    }

    int kind_;
    double sum_ = 0, peak_ = 0, slow_ = 0;
};

TEMPLATE_TEST_CASE("a limit is exceeded as often as specified, for every distribution", "[monitor]", float,
                   double) {
    DFDYN_SEEDED_ENGINE(engine);
    const int kind = GENERATE(0, 1, 2);
    CAPTURE(kind);
    constexpr int between = 20000;
    constexpr int repetitions = 150;
    int exceeded = 0;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        FalseAlarmThreshold<TestType> tail;
        Walk walk(kind);
        for (int block = 0; block < 3000; ++block) { // few blocks, which determine the tail poorly
            tail.add(static_cast<TestType>(walk.step(engine)));
            tail.add_block();
        }
        const TestType limit = tail.limit(between);
        for (int block = 0; block < between; ++block) {
            exceeded += static_cast<TestType>(walk.step(engine)) > limit ? 1 : 0;
        }
    }
    CHECK(exceeded < 2 * repetitions);
    CHECK(exceeded > repetitions / 20); // the limit is not far too high either
}

TEST_CASE("the limit decreases with the number of known excursions", "[monitor]") {
    FalseAlarmThreshold<double> tail;
    double last = tail.limit(1e6);
    for (int seen : {10, 100, 1000}) {
        for (int n = 0; n < seen; ++n) {
            tail.add(FalseAlarmThreshold<double>::base + 1.5);
            for (int block = 0; block < 40; ++block) {
                tail.add_block();
            }
        }
        CAPTURE(seen);
        CHECK(tail.limit(1e6) < last);
        last = tail.limit(1e6);
    }
    CHECK(tail.mean() == Approx(1.5).epsilon(0.01));
}

TEST_CASE("a single extreme height raises the limit by less than a factor of three", "[monitor]") {
    FalseAlarmThreshold<double> tail;
    const double before = tail.limit(1e6);
    tail.add(1e9);
    CHECK(tail.limit(1e6) < 3 * before);
}

} // namespace excursion_tail_test
