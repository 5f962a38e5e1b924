// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/monitor/change_detector.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <array>
#include <cmath>

namespace {

using namespace dfdyn;

constexpr int outputs = 3;
constexpr int blocks_per_hour = 36000; // of 0.1 s

/// Block means of innovations with a first-order autocorrelation from block to block, and tails of Student's
/// t with four degrees of freedom or none.
template <class Scalar>
class Innovations {
  public:
    Innovations(double autocorrelation, bool heavy) : a_(autocorrelation), heavy_(heavy) {}

    std::array<Scalar, outputs> next(std::mt19937_64& engine) {
        std::array<Scalar, outputs> means{};
        for (std::size_t k = 0; k < outputs; ++k) {
            const double fresh = heavy_ ? heavy_draw_(engine) : normal_(engine);
            state_[k] = a_ * state_[k] + std::sqrt(1 - a_ * a_) * fresh;
            means[k] = static_cast<Scalar>(0.4 * state_[k]);
        }
        return means;
    }

  private:
    double a_;
    bool heavy_;
    std::array<double, outputs> state_{};
    std::normal_distribution<double> normal_;
    std::student_t_distribution<double> heavy_draw_{4};
};

/// Alarms within so many blocks.
template <class Detector, class Scalar>
int alarms(Detector& detector, Innovations<Scalar>& innovations, int blocks, std::mt19937_64& engine) {
    int count = 0;
    for (int block = 0; block < blocks; ++block) {
        const bool before = detector.alarm();
        count += detector.add(innovations.next(engine).data()) && !before ? 1 : 0;
    }
    return count;
}

} // namespace

TEMPLATE_TEST_CASE("White, coloured and heavy-tailed innovations raise no more false alarms than stated",
                   "[monitor]", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    const bool heavy = GENERATE(false, true);
    const double autocorrelation = GENERATE(0.0, 0.6, 0.9);
    Innovations<TestType> innovations(autocorrelation, heavy);
    // one in six minutes, so that some would come
    ChangeDetector<TestType, outputs> detector({}, TestType(blocks_per_hour) / 10);
    const int count = alarms(detector, innovations, 4 * blocks_per_hour, engine);
    CAPTURE(heavy, autocorrelation, count);
    CHECK(count <= 40);
    CHECK(detector.usual(0).autocorrelation() == Approx(autocorrelation).margin(0.15));
}

TEMPLATE_TEST_CASE("A change of innovations is found, with its onset, and over when they are as usual again",
                   "[monitor]", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    const double autocorrelation = GENERATE(0.0, 0.5);
    Innovations<TestType> innovations(autocorrelation, true);
    ChangeDetector<TestType, outputs> detector({}, TestType(10 * blocks_per_hour));
    REQUIRE(alarms(detector, innovations, 1000, engine) == 0);
    int block = 0;
    for (; block < 40 && !detector.alarm(); ++block) {
        std::array<TestType, outputs> means = innovations.next(engine);
        means[1] += TestType(3); // 7.5 times what is usual
        detector.add(means.data());
    }
    CAPTURE(autocorrelation, block);
    REQUIRE(detector.alarm());
    CHECK(detector.channel() == 1);
    CHECK(block <= 15);
    CHECK(std::abs(detector.blocks_since_onset() - block) <= 3);
    int over = 0;
    for (; over < 200 && detector.alarm(); ++over) {
        detector.add(innovations.next(engine).data());
    }
    CHECK(over < 60);
    CHECK(alarms(detector, innovations, 5000, engine) == 0);
}

TEST_CASE("One block, however large, raises no alarm", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    Innovations<float> innovations(0.3, false);
    ChangeDetector<float, outputs> detector({}, 10.0F * blocks_per_hour);
    REQUIRE(alarms(detector, innovations, 1000, engine) == 0);
    const std::array<float, outputs> glitch{1e30F, -1e30F, 1e30F};
    CHECK_FALSE(detector.add(glitch.data()));
    CHECK(alarms(detector, innovations, 1000, engine) == 0);
}

TEST_CASE("A level that stays is adopted as usual", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    Innovations<double> innovations(0, false);
    ChangeDetector<double, outputs> detector({}, 10.0 * blocks_per_hour);
    REQUIRE(alarms(detector, innovations, 1000, engine) == 0);
    const auto louder = [&] {
        std::array<double, outputs> means = innovations.next(engine);
        means[0] *= 20;
        return means;
    };
    for (int block = 0; block < 50; ++block) {
        detector.add(louder().data());
    }
    REQUIRE(detector.alarm());
    detector.adopt();
    int alarmed = 0;
    for (int block = 0; block < 3000; ++block) {
        alarmed += detector.add(louder().data()) ? 1 : 0;
    }
    CHECK(alarmed == 0);
    CHECK(detector.usual(0).scale() == Approx(8).epsilon(0.4));
}
