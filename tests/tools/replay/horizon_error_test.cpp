// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/replay/horizon_error.hpp"

#include <cmath>
#include <cstddef>

namespace horizon_error_test {

using namespace dfdyn::tools;

/// A substitute for a model with two outputs. Its prediction is weight · column, and the test prescribes all
/// of these.
class PrescribedEstimator final : public RuntimeEstimator {
  public:
    std::vector<float> weights{0, 0};
    float column = 0;

    Tick tick(const MeasuredSample& /*sample*/, dfdyn::Budget /*budget*/) override { return {}; }
    bool advance(dfdyn::Budget /*budget*/) override { return true; }
    bool predict_with(std::span<const float> other, std::span<float> prediction) const override {
        prediction[0] = other[0] * column;
        prediction[1] = other[1] * column;
        return true;
    }
    std::size_t weight_count() const override { return weights.size(); }
    void copy_weights(std::span<float> copy) const override { std::ranges::copy(weights, copy.begin()); }
    void begin_recording() override {}
    std::vector<std::byte> snapshot() const override { return {}; }
    bool restore(std::span<const std::byte> /*snapshot*/) override { return false; }
    std::size_t state_bytes() const override { return 0; }
    dfdyn::Cost cost() const override { return {}; }
};

struct Step {
    std::vector<float> weights;
    float column;
    std::vector<double> measured;
};

std::vector<Step> random_steps(std::mt19937_64& engine, std::size_t count) {
    std::normal_distribution<float> normal;
    std::vector<Step> steps;
    for (std::size_t t = 0; t < count; ++t) {
        const auto number = [&] { return static_cast<double>(normal(engine)); };
        steps.push_back({{normal(engine), normal(engine)}, normal(engine), {number(), number()}});
    }
    return steps;
}

/// The relative prediction error over a horizon as the paper defines it.
double epsilon(const std::vector<Step>& steps, std::size_t t, std::size_t k, std::size_t horizon) {
    double error = 0;
    double power = 0;
    for (std::size_t s = 1; s <= horizon; ++s) {
        const double y = steps[t + s].measured[k];
        error += std::pow(y - static_cast<double>(steps[t].weights[k] * steps[t + s].column), 2);
        power += y * y;
    }
    return error / power;
}

std::vector<HorizonIndex> indices_of(const std::vector<Step>& steps, std::size_t horizon) {
    PrescribedEstimator estimator;
    HorizonError errors(horizon, 2, 2);
    for (const Step& step : steps) {
        estimator.column = step.column;
        estimator.weights = step.weights; // weights after learning this sample
        errors.add(estimator, step.measured);
    }
    return errors.indices();
}

TEST_CASE("the horizon index equals the paper's") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<Step> steps = random_steps(engine, 40);
    for (const std::size_t horizon : {std::size_t{1}, std::size_t{7}, std::size_t{25}}) {
        const std::vector<HorizonIndex> indices = indices_of(steps, horizon);
        REQUIRE(indices.size() == steps.size() - horizon);
        for (const HorizonIndex& index : indices) {
            for (std::size_t k = 0; k < 2; ++k) {
                CHECK(index.epsilon[k] == Approx(epsilon(steps, index.tick, k, horizon)).epsilon(1e-12));
            }
        }
    }
}

TEST_CASE("no horizon extends across a tick without a prediction") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<Step> steps = random_steps(engine, 10);
    PrescribedEstimator estimator;
    HorizonError errors(3, 2, 2);
    for (std::size_t t = 0; t < steps.size(); ++t) {
        if (t == 5) {
            errors.skip();
        } else {
            errors.add(estimator, steps[t].measured);
        }
    }
    std::vector<std::size_t> ticks;
    for (const HorizonIndex& index : errors.indices()) {
        ticks.push_back(index.tick);
    }
    CHECK(ticks == std::vector<std::size_t>{0, 1, 6});
}

TEST_CASE("no horizon extends across an interruption, which is no tick") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<Step> steps = random_steps(engine, 8);
    PrescribedEstimator estimator;
    HorizonError errors(3, 2, 2);
    for (std::size_t t = 0; t < steps.size(); ++t) {
        if (t == 4) {
            errors.interrupt();
        }
        errors.add(estimator, steps[t].measured);
    }
    std::vector<std::size_t> ticks;
    for (const HorizonIndex& index : errors.indices()) {
        ticks.push_back(index.tick);
    }
    CHECK(ticks == std::vector<std::size_t>{0, 4});
}

TEST_CASE("an output that stays at zero has no relative error") {
    PrescribedEstimator estimator;
    HorizonError errors(1, 2, 2);
    const std::vector<double> measured{0, 1};
    errors.add(estimator, measured);
    errors.add(estimator, measured);
    CHECK(std::isinf(errors.indices().front().epsilon[0]));
    CHECK(errors.indices().front().epsilon[1] == 1);
}

} // namespace horizon_error_test
