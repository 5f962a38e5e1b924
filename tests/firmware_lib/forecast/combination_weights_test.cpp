// SPDX-License-Identifier: Apache-2.0
#include "tests/firmware_lib/forecast/combination_of_three.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <limits>

// Weights of members whose deviations differ, and after refused samples.
namespace forecast_combination_test {

TEST_CASE("once errors are known only the ratio of a member's variances counts") {
    const double unjudged = Combination<double>::calibrated_variance_factor;
    Combination<double> combined({}, {}, 50, noise<double>.data(), unjudged);
    Values<double> deviations = noise<double>;
    deviations[1] = 2; // a variance of 3 of the parameters plus 1 of the noise
    const auto ratio = [&] {
        combined.weigh(deviations.data());
        return combined.weights()[1] / combined.weights()[3];
    };
    const auto inverse_square = [](double x) { return 1 / (x * x); };
    CHECK(ratio() == Approx(inverse_square(1 + 3 * unjudged)));
    const std::array<double, outputs> measured{};
    const Values<double> error{0.5, 1, 1, 1, 2, 1}; // the deviations of the noise
    for (int t = 0; t < 1000; ++t) {
        combined.weigh(deviations.data());
        combined.learn(error.data(), measured.data());
    }
    CHECK(ratio() == Approx(1).epsilon(1e-6));
    deviations[1] = 4; // four times the variance of the samples with these errors
    CHECK(ratio() == Approx(inverse_square(4)).epsilon(1e-6));
    for (int t = 0; t < 1000; ++t) {
        combined.skip();
    }
    CHECK(ratio() == Approx(inverse_square(1 + 15 * unjudged)).epsilon(1e-3));
}

TEST_CASE("infinite deviations of nearly noiseless members give equal weights before any error is known") {
    Values<float> noise_std{};
    noise_std.fill(1e-6F);
    Combination<float> combined(Extent<members>{}, Extent<outputs>{}, 100, noise_std.data());
    Values<float> deviations{};
    deviations.fill(GENERATE(std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(),
                             std::numeric_limits<float>::max()));
    combined.weigh(deviations.data());
    for (int i = 0; i < members * outputs; ++i) {
        CHECK(combined.weights()[i] == Approx(1.0 / members));
    }
    deviations[0] = noise_std[0];
    combined.weigh(deviations.data());
    CHECK(combined.weights()[0] == Approx(1));
}

TEMPLATE_TEST_CASE("a short spike of a bad member's deviation does not raise its weight afterwards", "",
                   float, double) {
    Combination<TestType> combined = scaled_combination<TestType>(50);
    const std::array<TestType, outputs> measured{};
    const Values<TestType> error{3, 3, 1, 1, 2, 2};
    const auto learn = [&](TestType deviation, int ticks) {
        Values<TestType> deviations = noise<TestType>;
        deviations[0] = deviation;
        for (int t = 0; t < ticks; ++t) {
            combined.weigh(deviations.data());
            combined.learn(error.data(), measured.data());
        }
        combined.weigh(noise<TestType>.data());
        return combined.weights()[0];
    };
    const TestType before = learn(noise<TestType>[0], 500);
    const auto [deviation, ticks] = GENERATE(
        table<TestType, int>({{std::numeric_limits<TestType>::infinity(), 1}, {1000, 5}, {1000, 50}}));
    CHECK(learn(deviation, ticks) <= TestType(1.05) * before);
    CHECK(learn(noise<TestType>[0], 1) <= TestType(1.05) * before);
}

TEST_CASE("after a memory without samples the weights follow the noise until the next sample") {
    Combination<double> combined = scaled_combination<double>(50);
    const std::array<double, outputs> measured{};
    const double start = combined.weights()[0];
    const Values<double> standing{3, 3, 0.01, 0.01, 3, 3}; // the second member is good at standstill
    for (int t = 0; t < 300; ++t) {
        combined.learn(standing.data(), measured.data());
    }
    CHECK(combined.weights()[2] > 0.99);
    for (int t = 0; t < 500; ++t) {
        combined.skip();
    }
    combined.weigh(noise<double>.data());
    CHECK(combined.weights()[0] == Approx(start).margin(0.01));
    for (int t = 0; t < 300; ++t) {
        combined.learn(standing.data(), measured.data());
    }
    CHECK(combined.weights()[2] > 0.99);
}

/// One sample: the first member is best one step ahead, the second one in predictions ahead.
void learn_tracking(Combination<double>& combined) {
    constexpr std::array<double, outputs> measured{};
    constexpr Values<double> one_step{0.1, 0.1, 0.3, 0.3, 5, 5};
    constexpr Values<double> ahead{2, 2, 0.3, 0.3, 5, 5};
    combined.learn(one_step.data(), ahead.data(), measured.data());
}

TEST_CASE("a member that only tracks has less weight in predictions ahead and without learning") {
    Combination<double> combined = scaled_combination<double>(50);
    for (int t = 0; t < 500; ++t) {
        learn_tracking(combined);
    }
    CHECK(combined.weights()[0] > 0.98);
    Values<double> of_ahead{};
    combined.copy_mean_squares(of_ahead.data());
    combined.weigh(of_ahead.data(), noise<double>.data(), of_ahead.data());
    CHECK(of_ahead[2] > 0.99);
    for (int t = 0; t < 7; ++t) { // more than an eighth of the memory
        combined.skip();
    }
    combined.weigh(noise<double>.data());
    CHECK(combined.weights()[2] > 0.99);
    learn_tracking(combined);
    CHECK(combined.weights()[0] > 0.9);
}

TEST_CASE("a single refused sample changes the combined prediction by little") {
    Combination<double> combined = scaled_combination<double>(50);
    for (int t = 0; t < 500; ++t) {
        learn_tracking(combined);
    }
    const auto predicted = [&] {
        std::array<double, outputs> to{};
        combined.weigh(noise<double>.data());
        combined.combine(Values<double>{0, 0, 1, 1, 2, 2}.data(), to.data());
        return to;
    };
    const std::array<double, outputs> before = predicted();
    combined.skip();
    CHECK(predicted()[0] == Approx(before[0]).margin(0.02));
    CHECK(predicted()[1] == Approx(before[1]).margin(0.02));
    learn_tracking(combined);
    CHECK(predicted()[0] == Approx(before[0]).margin(0.02));
}

} // namespace forecast_combination_test
