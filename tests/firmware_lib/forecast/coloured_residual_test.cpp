// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/coloured_residual.hpp"

#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace coloured_residual_test {

using dfdyn::Extent;
using dfdyn::SnapshotResult;

constexpr int outputs = 2;

template <class Scalar>
using State = dfdyn::ColouredResidual<Scalar, outputs>;

template <class Scalar>
using Values = std::array<Scalar, outputs>;

template <class Scalar>
State<Scalar> state(Scalar memory = 300) {
    const Values<Scalar> noise{Scalar(0.5), Scalar(0.5)};
    return {Extent<outputs>{}, memory, noise.data()};
}

/// Predictions and measurements: a smooth motion, with model errors that are AR(1) with the given coefficient
/// in the first output and white in the second.
class Samples {
  public:
    explicit Samples(double coefficient) : coefficient_(coefficient) {}

    template <class Scalar>
    void next(std::mt19937_64& engine, Values<Scalar>& prediction, Values<Scalar>& measured) {
        ++tick_;
        const double smooth = 5 * std::sin(0.3 * tick_);
        innovation_ = std::sqrt(1 - coefficient_ * coefficient_) * normal_(engine);
        error_ = coefficient_ * error_ + innovation_;
        prediction = {Scalar(smooth), Scalar(smooth)};
        measured = {Scalar(smooth + error_), Scalar(smooth + normal_(engine))};
    }

    /// The unpredictable part of the first output.
    double innovation() const { return innovation_; }

  private:
    double coefficient_;
    double error_ = 0;
    double innovation_ = 0;
    int tick_ = 0;
    std::normal_distribution<double> normal_;
};

/// Sums of squared errors of each output, over the ticks that were added.
struct Errors {
    Values<double> model{}, persistence{}, forecast{};
    double innovation = 0; ///< of the first output
};

template <class Scalar>
Errors errors_of(State<Scalar>& state, Samples samples, int ticks, std::mt19937_64& engine) {
    Errors errors;
    Values<Scalar> prediction{}, measured{}, one_step{}, last{};
    for (int t = 0; t < ticks; ++t) {
        samples.next(engine, prediction, measured);
        state.forecast(prediction.data(), one_step.data());
        if (t >= ticks / 2) {
            errors.innovation += samples.innovation() * samples.innovation();
            for (std::size_t k = 0; k < outputs; ++k) {
                const auto square = [&](Scalar value) { return std::pow(double(measured[k] - value), 2); };
                errors.model[k] += square(prediction[k]);
                errors.persistence[k] += square(last[k]);
                errors.forecast[k] += square(one_step[k]);
            }
        }
        state.learn(prediction.data(), measured.data());
        last = measured;
    }
    return errors;
}

TEMPLATE_TEST_CASE("the forecast error of a coloured residual is close to its innovation", "", float,
                   double) {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double coefficient : {0.0, 0.5, 0.9, 0.98}) {
        CAPTURE(coefficient);
        State<TestType> learned = state<TestType>(2000);
        const Errors errors = errors_of(learned, Samples(coefficient), 8000, engine);
        CHECK(errors.forecast[0] < 1.05 * errors.innovation);
        CHECK(errors.forecast[0] < 1.02 * errors.persistence[0]);
        CHECK(errors.forecast[1] < 1.02 * errors.model[1]); // white noise: no gain and a small loss
        CHECK(static_cast<double>(learned.correlation(0)) == Approx(coefficient).margin(0.1));
    }
}

TEST_CASE("with a useless model the forecast is as good as an autoregression of the output") {
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<double> normal;
    State<double> learned = state<double>(2000);
    double y1 = 0, y2 = 0, by_truth = 0, by_state = 0, by_persistence = 0;
    for (int t = 0; t < 8000; ++t) {
        const double expected = 1.6 * y1 - 0.7 * y2;
        const double y = expected + normal(engine);
        const Values<double> wild{30 * normal(engine), 30 * normal(engine)};
        Values<double> one_step{};
        learned.forecast(wild.data(), one_step.data());
        if (t > 4000) {
            by_truth += (y - expected) * (y - expected);
            by_state += (y - one_step[0]) * (y - one_step[0]);
            by_persistence += (y - y1) * (y - y1);
        }
        const Values<double> measured{y, y};
        learned.learn(wild.data(), measured.data());
        y2 = y1;
        y1 = y;
    }
    CHECK(by_state < 0.9 * by_persistence);
    CHECK(by_state < 1.4 * by_truth);
}

TEMPLATE_TEST_CASE("a spike is forgotten within a few samples, and the coefficients are kept", "", float,
                   double) {
    DFDYN_SEEDED_ENGINE(engine);
    for (const TestType spike :
         {TestType(1e3), TestType(1e14), std::numeric_limits<TestType>::max(),
          std::numeric_limits<TestType>::infinity(), std::numeric_limits<TestType>::quiet_NaN()}) {
        CAPTURE(spike);
        State<TestType> hit = state<TestType>();
        Samples samples(0.9);
        Values<TestType> prediction{}, measured{}, one_step{};
        for (int t = 0; t < 2000; ++t) {
            samples.next(engine, prediction, measured);
            hit.learn(prediction.data(), measured.data());
        }
        const TestType before = hit.correlation(0);
        samples.next(engine, prediction, measured);
        const Values<TestType> wrong{spike, spike};
        hit.learn(prediction.data(), wrong.data());
        double largest = 0;
        for (int t = 0; t < 300; ++t) {
            samples.next(engine, prediction, measured);
            hit.forecast(prediction.data(), one_step.data());
            REQUIRE(std::isfinite(one_step[0]));
            if (t >= 3) {
                largest = std::max(largest, std::abs(static_cast<double>(one_step[0] - prediction[0])));
            }
            hit.learn(prediction.data(), measured.data());
        }
        CHECK(largest < 6);
        CHECK(std::abs(hit.correlation(0) - before) < TestType(0.35));
    }
}

TEMPLATE_TEST_CASE("for any input the forecast is finite and the correlation below one", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    using Limits = std::numeric_limits<TestType>;
    const std::array<TestType, 9> odd{0,
                                      Limits::denorm_min(),
                                      TestType(1e-20),
                                      TestType(1e14),
                                      TestType(-1e14),
                                      Limits::max(),
                                      -Limits::max(),
                                      Limits::infinity(),
                                      Limits::quiet_NaN()};
    std::normal_distribution<double> normal;
    State<TestType> learned = state<TestType>(5);
    Values<TestType> one_step{};
    const auto value = [&](std::size_t finite) {
        const std::size_t choice = engine() % 20;
        return choice < finite ? odd[choice] : TestType(normal(engine));
    };
    for (int t = 0; t < 20'000; ++t) {
        const Values<TestType> prediction{value(5), value(5)}; // the predictions of an estimator are bounded
        const Values<TestType> measured{value(9), value(9)};
        learned.forecast(prediction.data(), one_step.data());
        for (const TestType forecast : one_step) {
            REQUIRE(std::isfinite(forecast));
        }
        REQUIRE(std::abs(learned.correlation(0)) < 1);
        if (engine() % 50 == 0) {
            learned.restart();
        }
        learned.learn(engine() % 10 == 0 ? nullptr : prediction.data(), measured.data());
    }
}

TEST_CASE("the forecast after a gap is the prediction and then uses the coefficients again") {
    DFDYN_SEEDED_ENGINE(engine);
    State<double> learned = state<double>();
    errors_of(learned, Samples(0.95), 2000, engine);
    learned.restart();
    const Values<double> prediction{3, 4};
    const Values<double> measured{5, 4};
    Values<double> one_step{};
    learned.forecast(prediction.data(), one_step.data());
    CHECK(one_step == prediction);
    learned.learn(prediction.data(), measured.data());
    learned.forecast(prediction.data(), one_step.data());
    CHECK(one_step[0] > 4.5); // 3 plus about 0.95 of the residual of 2
    CHECK(one_step[0] < 5.1);
}

TEST_CASE("measurements without a prediction are available as the last output when predictions begin") {
    State<double> learned = state<double>();
    const Values<double> measured{7, -7};
    for (int t = 0; t < 10; ++t) {
        learned.learn(nullptr, measured.data());
    }
    const Values<double> prediction{100, -100};
    Values<double> one_step{};
    learned.forecast(prediction.data(), one_step.data());
    CHECK(one_step[0] < 13); // the difference from the model is clipped to ten times the noise
    CHECK(one_step[1] > -13);
}

TEST_CASE("a residual state continues from its snapshot and rejects any other") {
    DFDYN_SEEDED_ENGINE(engine);
    State<float> learned = state<float>();
    errors_of(learned, Samples(0.9), 500, engine);
    std::vector<std::byte> bytes(learned.snapshot_bytes());
    REQUIRE(learned.snapshot(bytes) == SnapshotResult::ok);
    State<float> other = state<float>();
    REQUIRE(other.restore(bytes) == SnapshotResult::ok);
    CHECK(other.correlation(0) == learned.correlation(0));
    learned.restart();
    std::mt19937_64 same = engine;
    CHECK(errors_of(other, Samples(0.9), 100, same).forecast ==
          errors_of(learned, Samples(0.9), 100, engine).forecast);
    const std::array<float, 3> noise{1, 1, 1};
    dfdyn::ColouredResidual<float, 3> larger(Extent<3>{}, 300, noise.data());
    CHECK(larger.restore(bytes) != SnapshotResult::ok);
    bytes.back() ^= std::byte{1};
    CHECK(other.restore(bytes) == SnapshotResult::corrupted);
}

TEST_CASE("a residual state restores the snapshots of any memory, also before it has learned") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::array<float, 2> noise{1, 1};
    State<float> learned = state<float>();
    errors_of(learned, Samples(0.9), 500, engine);
    State<float> shortest(Extent<2>{}, 1, noise.data());
    for (const State<float>* const written : {&learned, &shortest}) {
        std::vector<std::byte> bytes(written->snapshot_bytes());
        REQUIRE(written->snapshot(bytes) == SnapshotResult::ok);
        State<float> other(Extent<2>{}, 1, noise.data());
        CHECK(other.restore(bytes) == SnapshotResult::ok);
        CHECK(other.correlation(0) == written->correlation(0));
    }
}

TEST_CASE("a residual state takes 60 bytes per output and no heap") {
    CHECK(sizeof(dfdyn::ColouredResidual<float, 6>) <= 6 * 60 + 64);
    State<float> learned = state<float>();
    const Values<float> values{1, 2};
    Values<float> one_step{};
    const dfdyn::tests::AllocationGuard guard;
    learned.learn(values.data(), values.data());
    learned.forecast(values.data(), one_step.data());
    learned.restart();
    CHECK(guard.calls().allocations == 0);
}

} // namespace coloured_residual_test
