// SPDX-License-Identifier: Apache-2.0
// Hours of samples in float: neither forgetting nor rounding destroys the learned state.
#include "dfdyn/learner/ud_covariance.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/slow_build.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace hours_test {

using namespace dfdyn;
using dfdyn::tests::slow_build;

/// Smooth periodic motion of two joints with a period of `instants` samples, as rows of `columns` random
/// features with total norm one.
template <int columns>
class Motion {
  public:
    static constexpr int instants = 2000;
    using Row = std::array<float, columns>;

    explicit Motion(std::mt19937_64& engine) : rows_(instants) {
        std::normal_distribution<double> normal;
        std::uniform_real_distribution<double> phase(0, 2 * std::numbers::pi);
        std::array<double, 4> phases{};
        std::array<std::array<double, 4>, columns / 2> frequencies{};
        std::generate(phases.begin(), phases.end(), [&] { return phase(engine); });
        for (auto& frequency : frequencies) {
            std::generate(frequency.begin(), frequency.end(), [&] { return normal(engine); });
        }
        for (int t = 0; t < instants; ++t) {
            std::array<double, 4> state{}; // two positions and two velocities
            for (std::size_t i = 0; i < 4; ++i) {
                const double turns = static_cast<double>(3 + 2 * i) * t / instants;
                state[i] = std::sin(2 * std::numbers::pi * turns + phases[i]);
            }
            rows_[static_cast<std::size_t>(t)] = features(frequencies, state);
        }
    }

    [[nodiscard]] const Row& row(std::int64_t t) const {
        return rows_[static_cast<std::size_t>(t % instants)];
    }

  private:
    template <class Frequencies>
    static Row features(const Frequencies& frequencies, const std::array<double, 4>& state) {
        Row row{};
        for (std::size_t i = 0; i < columns / 2; ++i) {
            double angle = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                angle += frequencies[i][k] * state[k];
            }
            row[2 * i] = static_cast<float>(std::cos(angle) / std::sqrt(columns / 2));
            row[2 * i + 1] = static_cast<float>(std::sin(angle) / std::sqrt(columns / 2));
        }
        return row;
    }

    std::vector<Row> rows_;
};

/// Fast noise of unit variance: the sum of the four parts of a 64-bit random number.
class Noise {
  public:
    explicit Noise(std::uint64_t seed) : state_(seed | 1) {}
    double operator()() {
        state_ ^= state_ << 13U;
        state_ ^= state_ >> 7U;
        state_ ^= state_ << 17U;
        std::int64_t sum = 0;
        for (unsigned part = 0; part < 4; ++part) {
            sum += static_cast<std::int64_t>(state_ >> (16U * part) & 0xFFFFU);
        }
        return (static_cast<double>(sum) / 65536 - 2) * std::sqrt(3.0);
    }

  private:
    std::uint64_t state_;
};

/// A learner in `Scalar` of an arm with weights drawn from the prior.
template <class Scalar, int columns = 32>
class Arm {
  public:
    Arm(std::mt19937_64& engine, double prior_variance, double forgetting_factor)
        : motion_(engine), noise_(engine()), constants_{static_cast<Scalar>(prior_variance),
                                                        static_cast<Scalar>(forgetting_factor), nullptr},
          learner_(constants_, {}, {}) {
        std::normal_distribution<double> normal(0, std::sqrt(prior_variance));
        std::generate(weights_.begin(), weights_.end(), [&] { return normal(engine); });
    }

    void move(std::int64_t samples) {
        for (std::int64_t t = 0; t < samples; ++t) {
            learn(motion_.row(instant_++));
        }
    }
    void stand(std::int64_t samples) {
        for (std::int64_t t = 0; t < samples; ++t) {
            learn(motion_.row(instant_));
        }
    }

    /// Returns the root mean square error of the mean over the motion, in standard deviations of the noise.
    [[nodiscard]] double error() const {
        double squares = 0;
        for (int t = 0; t < Motion<columns>::instants; ++t) {
            const auto row = scalars(motion_.row(t));
            Scalar mean = 0;
            learner_.predict(row.data(), &mean);
            squares += std::pow(static_cast<double>(mean) - truth(motion_.row(t)), 2);
        }
        return std::sqrt(squares / Motion<columns>::instants);
    }

    /// Returns the root mean square of the learner's own standard deviation, in the same unit.
    [[nodiscard]] double deviation() const {
        double sum = 0;
        for (int t = 0; t < Motion<columns>::instants; ++t) {
            sum += static_cast<double>(learner_.variance(scalars(motion_.row(t)).data()));
        }
        return std::sqrt(sum / Motion<columns>::instants);
    }

    /// Returns the mean square of the innovations since the last call, each in units of its variance.
    [[nodiscard]] double normalised_innovation() {
        const double mean = innovation_squares_ / static_cast<double>(learned_);
        innovation_squares_ = 0;
        learned_ = 0;
        return mean;
    }

  private:
    using Row = typename Motion<columns>::Row;

    static std::array<Scalar, columns> scalars(const Row& row) {
        std::array<Scalar, columns> result{};
        std::copy(row.begin(), row.end(), result.begin());
        return result;
    }

    [[nodiscard]] double truth(const Row& row) const {
        double sum = 0;
        for (std::size_t i = 0; i < columns; ++i) {
            sum += weights_[i] * static_cast<double>(row[i]);
        }
        return sum;
    }

    void learn(const Row& original) {
        const auto row = scalars(original);
        const auto target = static_cast<Scalar>(truth(original) + noise_());
        Scalar mean = 0;
        learner_.predict(row.data(), &mean);
        Budget budget = Budget::unlimited();
        learner_.begin(row.data(), &target);
        learner_.advance(budget);
        const auto innovation = static_cast<double>(target - mean);
        innovation_squares_ += innovation * innovation / static_cast<double>(learner_.last_variance_ratio());
        ++learned_;
    }

    using Learner = UdCovariance<Scalar, columns, 1>;

    Motion<columns> motion_;
    Noise noise_;
    typename Learner::Constants constants_;
    Learner learner_;
    std::array<double, columns> weights_{};
    std::int64_t instant_ = 0;
    double innovation_squares_ = 0;
    std::int64_t learned_ = 0;
};

// The information of a repeated row decreases as 1/t in exact arithmetic. Neither this information nor its
// rounding error allows more forgetting.
TEST_CASE("an arm that rests for an hour keeps the model of its motion in float as in double") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double forgetting_factor : {0.999, 0.9999}) {
        CAPTURE(forgetting_factor);
        auto same = engine;
        Arm<float> arm(engine, 1000, forgetting_factor);
        Arm<double> exact(same, 1000, forgetting_factor);
        arm.move(100'000);
        exact.move(100'000);
        CHECK(arm.error() < 0.25);
        const double moved = exact.deviation();
        arm.stand(slow_build ? 200'000 : 3'000'000);
        exact.stand(slow_build ? 200'000 : 3'000'000);
        CHECK(exact.deviation() < 10 * moved); // two horizons of forgetting, for a standstill of any length
        CHECK(arm.deviation() <= 1.01 * exact.deviation());
        CHECK(arm.error() < 0.25);
        CHECK(arm.normalised_innovation() == Approx(1).margin(0.1));
    }
}

TEMPLATE_TEST_CASE("once an arm at rest has nothing more to forget, its covariance stays as it is", "", float,
                   double) {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr int columns = 100;
    constexpr double forgetting_factor = 0.9999;
    auto same = engine;
    Arm<TestType, columns> arm(engine, 1e8, forgetting_factor);
    Arm<double, columns> exact(same, 1e8, forgetting_factor);
    arm.move(20'000);
    exact.move(20'000);
    const double moved = exact.error();
    arm.stand(60'000); // several horizons
    exact.stand(60'000);
    const double rested = arm.deviation();
    CHECK(rested == Approx(exact.deviation()).epsilon(0.15));
    arm.stand(20'000);
    CHECK(arm.deviation() == rested);
    CHECK(arm.error() < 1.2 * moved);
}

/// Checks that a motion of `samples` samples at a high signal-to-noise ratio is learned as accurately as the
/// learner's standard deviation predicts.
template <int columns>
void check_motion(std::mt19937_64& engine, double prior_variance, std::int64_t samples) {
    CAPTURE(prior_variance, columns);
    Arm<float, columns> arm(engine, prior_variance, 1);
    arm.move(samples / 2);
    static_cast<void>(arm.normalised_innovation());
    arm.move(samples - samples / 2);
    CHECK(arm.error() < 3 * arm.deviation());
    CHECK(arm.normalised_innovation() == Approx(1).margin(0.02));
}

TEST_CASE("an arm that moves for hours without forgetting has the error that the learner predicts") {
    DFDYN_SEEDED_ENGINE(engine);
    check_motion<32>(engine, 1e7, slow_build ? 200'000 : 10'000'000);
}

TEST_CASE("an arm that moves for a day without forgetting has the error that the learner predicts",
          "[.long]") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double prior_variance : {1e4, 1e7}) {
        check_motion<32>(engine, prior_variance, 100'000'000);
        check_motion<100>(engine, prior_variance, 100'000'000);
    }
}

/// Schedule of motion and standstill.
enum class Day { moving, coming_and_going, standing };

template <class Arm>
void spend(Arm& arm, Day day, std::int64_t samples) {
    constexpr std::int64_t moving = 10'000;
    constexpr std::int64_t standing = 100'000;
    if (day == Day::coming_and_going) {
        for (std::int64_t t = 0; t < samples; t += moving + standing) {
            arm.move(moving);
            arm.stand(standing);
        }
        return;
    }
    arm.move(day == Day::moving ? samples : standing);
    arm.stand(day == Day::moving ? 0 : samples - standing);
}

/// Runs a schedule at a signal-to-noise ratio of 10⁴.
template <int columns>
void check_day(std::mt19937_64& engine, std::int64_t samples) {
    for (const double forgetting_factor : {1.0, 0.9999}) {
        for (const Day day : {Day::moving, Day::coming_and_going, Day::standing}) {
            CAPTURE(columns, forgetting_factor, static_cast<int>(day));
            auto same = engine;
            Arm<float, columns> arm(engine, 1e8, forgetting_factor);
            Arm<double, columns> exact(same, 1e8, forgetting_factor);
            arm.move(20'000);
            exact.move(20'000);
            static_cast<void>(arm.normalised_innovation());
            spend(arm, day, samples);
            spend(exact, day, samples);
            const double innovation = arm.normalised_innovation();
            CHECK(arm.error() < 2 * exact.error());
            CHECK(innovation > 0.8);
            CHECK(innovation < 1.25);
        }
    }
}

TEST_CASE("minutes of moving, standing still or both give the same error in float as in double") {
    DFDYN_SEEDED_ENGINE(engine);
    check_day<32>(engine, slow_build ? 120'000 : 600'000);
}

TEST_CASE("a day of moving, standing still or both gives the same error in float as in double", "[.long]") {
    DFDYN_SEEDED_ENGINE(engine);
    check_day<32>(engine, 100'000'000);
    check_day<100>(engine, 10'000'000);
}

} // namespace hours_test
