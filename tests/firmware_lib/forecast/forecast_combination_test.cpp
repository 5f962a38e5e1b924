// SPDX-License-Identifier: Apache-2.0
#include "tests/firmware_lib/forecast/combination_of_three.hpp"

#include "tests/firmware_lib/support/counted.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace forecast_combination_test {

/// The weights from all errors at once, in double: the recursion must agree while its memory is not full.
template <class Scalar>
std::vector<double> batch_weights(const std::vector<Values<Scalar>>& errors) {
    std::vector<double> weights(static_cast<std::size_t>(members) * outputs);
    for (std::size_t k = 0; k < outputs; ++k) {
        double sum = 0;
        for (std::size_t j = 0; j < members; ++j) {
            double square = 0;
            for (const Values<Scalar>& error : errors) {
                const auto e = static_cast<double>(error[j * outputs + k]);
                square += e * e / static_cast<double>(errors.size());
            }
            sum += weights[j * outputs + k] = 1 / (square * square);
        }
        for (std::size_t j = 0; j < members; ++j) {
            weights[j * outputs + k] /= sum;
        }
    }
    return weights;
}

TEMPLATE_TEST_CASE("members have equal weights before the first errors", "", float, double) {
    const Combination<TestType> combined = combination<TestType>(100);
    const Values<TestType> from{1, 10, 2, 20, 6, 60};
    std::array<TestType, outputs> to{};
    combined.combine(from.data(), to.data());
    CHECK(to[0] == Approx(3));
    CHECK(to[1] == Approx(30));
}

TEMPLATE_TEST_CASE("weights are inversely proportional to the square of the mean square error", "", float,
                   double) {
    DFDYN_SEEDED_ENGINE(engine);
    Combination<TestType> combined = combination<TestType>(500);
    const std::array<TestType, outputs> measured{};
    std::vector<Values<TestType>> errors;
    for (int t = 0; t < 500; ++t) {
        errors.push_back(predictions<TestType>(engine));
        combined.learn(errors.back().data(), measured.data());
    }
    const std::vector<double> expected = batch_weights(errors);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        CHECK(static_cast<double>(combined.weights()[i]) == Approx(expected[i]).epsilon(1e-4));
    }
    CHECK(combined.weights()[0] > TestType(0.85)); // 1 against 1/16 and 1/256
}

TEST_CASE("the weights follow within the memory if members exchange their errors") {
    Combination<double> combined = combination<double>(50);
    const std::array<double, outputs> measured{};
    const Values<double> first_good{0.1, 0.1, 1, 1, 5, 5};
    const Values<double> last_good{5, 5, 1, 1, 0.1, 0.1};
    for (int t = 0; t < 1000; ++t) {
        combined.learn(first_good.data(), measured.data());
    }
    CHECK(combined.weights()[0] > 0.999);
    for (int t = 0; t < 300; ++t) { // six memories, as the old error was 2500 times the new one
        combined.learn(last_good.data(), measured.data());
    }
    CHECK(combined.weights()[4] > 0.98);
    combined.restart();
    CHECK(combined.weights()[0] == Approx(1.0 / 3));
}

TEMPLATE_TEST_CASE("after any errors the combination lies between its members", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr TestType infinite = std::numeric_limits<TestType>::infinity();
    const std::array<TestType, 6> odd{0,
                                      std::numeric_limits<TestType>::denorm_min(),
                                      std::numeric_limits<TestType>::max(),
                                      -std::numeric_limits<TestType>::max(),
                                      infinite,
                                      std::numeric_limits<TestType>::quiet_NaN()};
    std::uniform_int_distribution<std::size_t> pick(0, 2 * odd.size());
    Combination<TestType> combined =
        GENERATE(false, true) ? scaled_combination<TestType>(7) : combination<TestType>(7);
    std::array<TestType, outputs> to{};
    for (int t = 0; t < 10'000; ++t) {
        Values<TestType> from = predictions<TestType>(engine);
        std::array<TestType, outputs> measured{};
        for (TestType& value : from) {
            const std::size_t choice = pick(engine);
            value = choice < odd.size() ? odd[choice] : value;
        }
        measured[0] = odd[pick(engine) % odd.size()];
        Values<TestType> ahead = predictions<TestType>(engine);
        ahead[pick(engine) % ahead.size()] = odd[pick(engine) % odd.size()];
        combined.learn(from.data(), ahead.data(), measured.data());
        if (pick(engine) % 2 == 0) {
            combined.skip();
            combined.weigh(ahead.data()); // any deviations are allowed
        }
        from = predictions<TestType>(engine);
        combined.combine(from.data(), to.data());
        for (std::size_t k = 0; k < outputs; ++k) {
            const auto [low, high] = std::minmax({from[k], from[outputs + k], from[2 * outputs + k]});
            const TestType rounding = 8 * std::numeric_limits<TestType>::epsilon() * (high - low);
            REQUIRE(to[k] >= low - rounding);
            REQUIRE(to[k] <= high + rounding);
        }
    }
}

TEMPLATE_TEST_CASE("an output without a measured value keeps its weights while the other one is learned", "",
                   float, double) {
    using Limits = std::numeric_limits<TestType>;
    Combination<TestType> combined = combination<TestType>(50);
    const Values<TestType> first_good{TestType(0.1), TestType(0.1), 1, 1, 5, 5};
    const Values<TestType> last_good{5, 5, 1, 1, TestType(0.1), TestType(0.1)};
    const std::array<TestType, outputs> both{};
    for (int t = 0; t < 500; ++t) {
        combined.learn(first_good.data(), both.data());
    }
    const TestType before = combined.weights()[1];
    REQUIRE(before > TestType(0.99));
    for (int t = 0; t < 300; ++t) {
        const std::array<TestType, outputs> one{0, t % 2 == 0 ? Limits::quiet_NaN() : Limits::infinity()};
        combined.learn(last_good.data(), one.data());
    }
    CHECK(combined.weights()[1] == before);
    CHECK(combined.weights()[4] > TestType(0.98));
}

TEMPLATE_TEST_CASE("an absurdly large error is forgotten within five memories", "", float, double) {
    Combination<TestType> combined = combination<TestType>(50);
    const std::array<TestType, outputs> measured{};
    const Values<TestType> good{1, 1, TestType(0.1), TestType(0.1), 2, 2};
    Values<TestType> absurd = good;
    absurd[outputs] = std::numeric_limits<TestType>::quiet_NaN();
    for (int t = 0; t < 500; ++t) {
        combined.learn(good.data(), measured.data());
    }
    CHECK(combined.weights()[outputs] > TestType(0.99));
    combined.learn(absurd.data(), measured.data());
    CHECK(combined.weights()[outputs] < TestType(0.5));
    for (int t = 0; t < 250; ++t) {
        combined.learn(good.data(), measured.data());
    }
    CHECK(combined.weights()[outputs] > TestType(0.99));
}

TEMPLATE_TEST_CASE("before the first errors members are weighted by their known noise", "", float, double) {
    const Combination<TestType> combined = scaled_combination<TestType>(100);
    const double sum = 16 + 1 + 1.0 / 16; // 1/σ⁴
    CHECK(combined.weights()[0] == Approx(16 / sum));
    CHECK(combined.weights()[2] == Approx(1 / sum));
    CHECK(combined.weights()[4] == Approx(1.0 / 16 / sum));
    CHECK(combined.weights()[1] == Approx(1.0 / 3));
}

TEMPLATE_TEST_CASE("a member with uncertain parameters at an input has less weight there", "", float,
                   double) {
    const TestType factor =
        GENERATE(Combination<TestType>::variance_factor, Combination<TestType>::calibrated_variance_factor);
    Combination<TestType> combined(Extent<members>{}, Extent<outputs>{}, 100, noise<TestType>.data(), factor);
    Values<TestType> deviations = noise<TestType>;
    combined.weigh(deviations.data());
    const TestType before = combined.weights()[1];
    CHECK(before == Approx(1.0 / 3));
    deviations[1] = 2; // a variance of 3 of the parameters plus 1 of the noise
    combined.weigh(deviations.data());
    const double doubtful = 1 + 3 * static_cast<double>(factor);
    CHECK(combined.weights()[1] == Approx(1 / (doubtful * doubtful) / (2 + 1 / (doubtful * doubtful))));
    CHECK(combined.weights()[3] == combined.weights()[5]);
    deviations[1] = std::numeric_limits<TestType>::infinity();
    combined.weigh(deviations.data());
    CHECK(combined.weights()[1] < TestType(1e-6));
    combined.weigh(noise<TestType>.data()); // the effect is limited to one input
    CHECK(combined.weights()[1] == before);
}

TEST_CASE("a rejected snapshot does not change a combination between two samples") {
    Combination<float> combined = scaled_combination<float>(50);
    const std::array<float, outputs> measured{};
    const Values<float> one_step{0.1F, 0.1F, 0.3F, 0.3F, 5, 5};
    const Values<float> ahead{2, 2, 0.3F, 0.3F, 5, 5};
    combined.learn(one_step.data(), ahead.data(), measured.data());
    std::vector<std::byte> bytes(combined.snapshot_bytes());
    REQUIRE(combined.snapshot(bytes) == SnapshotResult::ok);
    bytes.back() ^= std::byte{1};
    for (int t = 0; t < 20; ++t) {
        combined.skip();
    }
    Values<float> deviations = noise<float>;
    deviations[2] = 7;
    combined.weigh(deviations.data());
    Combination<float> untouched = combined;
    const auto same = [&] {
        return std::equal(combined.weights(), combined.weights() + members * outputs, untouched.weights());
    };
    REQUIRE(combined.restore(bytes) == SnapshotResult::corrupted);
    CHECK(same());
    for (Combination<float>* const each : {&combined, &untouched}) {
        each->weigh(deviations.data());
    }
    CHECK(same());
}

TEST_CASE("a combination continues from its snapshot and rejects any other") {
    DFDYN_SEEDED_ENGINE(engine);
    Combination<float> combined = combination<float>(100);
    const std::array<float, outputs> measured{};
    for (int t = 0; t < 30; ++t) {
        combined.learn(predictions<float>(engine).data(), measured.data());
    }
    std::vector<std::byte> bytes(combined.snapshot_bytes());
    REQUIRE(combined.snapshot(bytes) == SnapshotResult::ok);
    Combination<float> other = combination<float>(100);
    REQUIRE(other.restore(bytes) == SnapshotResult::ok);
    const Values<float> next = predictions<float>(engine);
    combined.learn(next.data(), measured.data());
    other.learn(next.data(), measured.data());
    for (int i = 0; i < members * outputs; ++i) {
        CHECK(other.weights()[i] == combined.weights()[i]);
    }
    CHECK(combination<float>(10).restore(bytes) == SnapshotResult::ok); // a shorter memory
    std::vector<std::byte> fresh(bytes.size());
    REQUIRE(combination<float>(100).snapshot(fresh) == SnapshotResult::ok);
    REQUIRE(other.restore(fresh) == SnapshotResult::ok);
    CHECK(other.weights()[0] == Approx(1.0 / 3));
    dfdyn::ForecastCombination<float, 2, 3> turned(Extent<2>{}, Extent<3>{}, 100);
    CHECK(turned.restore(bytes) == SnapshotResult::wrong_model);
    bytes.back() ^= std::byte{1};
    CHECK(other.restore(bytes) == SnapshotResult::corrupted);
}

/// Counts the multiply-adds of a call.
template <class Call>
std::int64_t count(const Call& call) {
    dfdyn::tests::counted_operations = 0;
    call();
    return dfdyn::tests::counted_operations;
}

TEMPLATE_TEST_CASE_SIG("a combination costs what its cost function says", "", ((int c, int m), c, m), (1, 1),
                       (2, 6), (5, 3)) {
    DFDYN_SEEDED_ENGINE(engine);
    using Number = dfdyn::tests::Counted<double>;
    using Counting = dfdyn::ForecastCombination<Number, c, m>;
    constexpr dfdyn::Cost cost = Counting::cost({}, {});
    std::lognormal_distribution<double> positive;
    std::array<Number, std::size_t{c} * m> from{}, ahead{}, deviations{};
    std::array<Number, m> measured{}, to{};
    Counting combined({}, {}, Number(20), from.data());
    std::int64_t most = 0;
    for (int t = 0; t < 100; ++t) {
        for (auto* const table : {&from, &ahead, &deviations}) {
            std::ranges::generate(*table, [&] { return Number(positive(engine)); });
        }
        REQUIRE(count([&] {
                    combined.weigh(deviations.data());
                    combined.combine(from.data(), to.data());
                    combined.combine(deviations.data(), to.data());
                }) == cost.predict);
        most = std::max(most, count([&] { combined.learn(from.data(), ahead.data(), measured.data()); }));
        most = std::max(most, count([&] { combined.skip(); }));
    }
    CHECK(most <= cost.learn);
    CHECK(most > cost.learn - c * m);
}

TEST_CASE("a combination does not allocate") {
    DFDYN_SEEDED_ENGINE(engine);
    Combination<float> combined = combination<float>(100);
    const Values<float> from = predictions<float>(engine);
    std::array<float, outputs> to{};
    std::array<std::byte, 256> bytes{};
    const dfdyn::tests::AllocationGuard guard;
    combined.learn(from.data(), from.data(), to.data());
    combined.weigh(from.data());
    combined.combine(from.data(), to.data());
    const SnapshotResult written = combined.snapshot(bytes);
    const SnapshotResult read = combined.restore(bytes);
    combined.restart();
    const dfdyn::tests::HeapCalls calls = guard.calls();
    CHECK(calls.allocations == 0);
    CHECK(written == SnapshotResult::ok);
    CHECK(read == SnapshotResult::ok);
}

} // namespace forecast_combination_test
