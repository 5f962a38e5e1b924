// SPDX-License-Identifier: Apache-2.0
// Away from the data the features' part of a prediction fades out, and its standard deviation grows.
#include "dfdyn/estimator.hpp"

#include "tests/firmware_lib/support/running_arm.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <limits>

namespace extrapolation_test {

using namespace dfdyn;
using namespace dfdyn::tests;

using Features = TestModel<float, DerivativeFreeReduced<6, 3>, 60>;
using Mean = TestMean<float, DerivativeFreeReduced<6, 3>, 60>;
using Kernel = TestKernel<float, DerivativeFreeReduced<6, 3>, 60>;
using Physics = TestParametric<float, DerivativeFreeReduced<6, 3>>;

/// 1 / (trace(P) / 2d) of the features' learner.
template <class Model>
float inverse_far_variance(const Estimator<Model>& estimator) {
    float trace = 0;
    for (int i = 0; i < Model::columns; ++i) {
        if constexpr (std::is_same_v<Model, Kernel>) {
            trace += estimator.regression().learner().factor().parameter_variance(i);
        } else {
            trace += estimator.regression().learner().parameter_variance(i);
        }
    }
    return static_cast<float>(Model::columns) / trace;
}

/// An arm that has learned 3,000 samples and is then evaluated away from them.
template <class Model>
struct StrayArm : RunningArm<Model> {
    explicit StrayArm(std::mt19937_64& engine) : RunningArm<Model>(engine, sharp(engine)) {
        for (int t = 0; t < 3000; ++t) {
            this->tick(this->due());
        }
    }

    static typename Model::Constants sharp(std::mt19937_64& engine) {
        auto constants = make_constants<Model>(engine);
        for (auto& frequency : constants.features.frequencies) {
            frequency *= 4; // a short length scale
        }
        constants.innovation_limit = 1000;
        constants.innovation_patience = 5;
        return constants;
    }

    /// Sets the constants that `dfdyn train` would measure.
    void know() {
        this->constants.extrapolation.inverse_far_variance = inverse_far_variance(this->estimator);
        this->constants.extrapolation.extra_noise = {{0.5F, 0.5F}};
        this->constants.extrapolation.prior_variance = {{900, 400}};
    }

    /// Returns the estimate `offset` rad away from the arm's position, without learning it.
    auto estimate_at(float offset) {
        this->estimator.restart_window();
        typename Estimator<Model>::Estimate estimate{};
        for (int t = 0; t < 7; ++t) {
            auto sample = this->due();
            for (float& position : sample.position) {
                position += offset;
            }
            estimate = this->estimator.tick(sample, Budget::predict_only());
        }
        return estimate;
    }

    /// Returns the physics' prediction at the present sample, in the output's unit.
    float without_features(int k) {
        std::array<float, 2> means{};
        this->estimator.regression().predict_without_features(means.data());
        const auto output = static_cast<std::size_t>(k);
        return this->constants.output_offset[k] + this->constants.output_noise_std[k] * means[output];
    }
};

TEST_CASE("doubt rises from zero at the data to nearly one far from them") {
    float last = 0;
    for (const float t : {0.0F, 0.01F, 0.03F, 0.1F, 0.2F, 0.5F, 0.8F, 1.0F, 30.0F}) {
        const Extrapolation<float> beyond(5 * t, 0.2F);
        CAPTURE(t);
        CHECK(beyond.doubt() >= last);
        CHECK(beyond.doubt() < 1);
        CHECK(beyond.unknown() <= 1);
        last = beyond.doubt();
    }
    CHECK(1 - Extrapolation<float>(0.03F, 1).doubt() >= 1 - 1e-7F);
    CHECK(Extrapolation<float>(1, 1).doubt() > 0.98F);
    CHECK(Extrapolation<float>(1, 1).unknown() == 1);
    CHECK(Extrapolation<float>(1, 1).variance(2, 1, 0.5F, 7) == 8.5F);
    // The parameters of the physics contribute 4 to the variance.
    CHECK(Extrapolation<float>(1, 1).variance(6, 1, 0.5F, 7) == 12.5F);
}

TEST_CASE("without the constants predictions and standard deviations equal the paper's, bit for bit") {
    const Extrapolation<float> paper(123.4F, 0);
    CHECK(paper.doubt() == 0);
    CHECK(paper.variance(124.4F, 123.4F, 0, 0) == 124.4F);
}

TEST_CASE("doubt of the physics rises with the variance of its parameters up to the variance of the output") {
    const Extrapolation<float> beyond(0, 0, 20);
    float last = 0;
    for (const float of_parameters : {0.0F, 0.01F, 1.0F, 5.0F, 40.0F, 1e10F, 1e30F}) {
        CAPTURE(of_parameters);
        const float doubt = beyond.parameter_doubt(1 + of_parameters, 0, 100);
        CHECK(doubt >= last);
        CHECK(doubt <= 1);
        CHECK(beyond.variance(1 + of_parameters, 0, 0.5F, 0, 100) <= 101.5F);
        CHECK(beyond.parameter_doubt(1 + of_parameters, 0, 0) == 0); // the output's variance is unknown
        last = doubt;
    }
    CHECK(last > 0.999F);
    CHECK(beyond.parameter_doubt(1 + 15, 0, 100) == 0.5F); // 20 times 15 is the square of the range
    CHECK(beyond.variance(3, 0, 0.5F, 0, 100) == 41.5F);
    CHECK(beyond.variance(1e10F, 0, 0.5F, 0, 100) == 101.5F);
    // The parameters contribute 3 to the variance.
    CHECK(Extrapolation<float>(2, 0.1F, 20).variance(6, 2, 0.5F, 0, 100) == 61.5F);
}

TEST_CASE("a variance that is not finite remains not finite") {
    for (const float ratio : {std::numeric_limits<float>::infinity(), std::nanf("")}) {
        CHECK_FALSE(std::isfinite(Extrapolation<float>(ratio, 1).variance(ratio, ratio, 1, 1)));
        CHECK_FALSE(std::isfinite(Extrapolation<float>(0, 0, 20).variance(ratio, 0, 1, 0, 100)));
    }
}

TEST_CASE("without a variance of the outputs the parameters' variance has the factor one") {
    DFDYN_SEEDED_ENGINE(engine);
    RunningArm<Physics> arm(engine, make_constants<Physics>(engine));
    const auto estimate_at_rest = [&] {
        arm.now = 200;
        arm.estimator.restart_window();
        typename Estimator<Physics>::Estimate estimate{};
        do {
            estimate = arm.estimator.tick(arm.due(), Budget::predict_only());
        } while (!estimate.status.predicted());
        return estimate;
    };
    const auto paper = estimate_at_rest();
    arm.constants.extrapolation.parameter_variance_factor = 1;
    arm.constants.extrapolation.output_variance = {{1e20F, 1e20F}};
    const auto once = estimate_at_rest();
    arm.constants.extrapolation.parameter_variance_factor = 1e6F;
    arm.constants.extrapolation.extra_noise = {{3, 3}};
    const auto often = estimate_at_rest();
    arm.constants.extrapolation.output_variance = {{1e-3F, 1e20F}};
    const auto open = estimate_at_rest();
    for (int k = 0; k < 2; ++k) {
        const float noise = arm.constants.output_noise_std[k];
        const auto variance = [&](const auto& estimate) {
            return estimate.standard_deviation[k] * estimate.standard_deviation[k] / (noise * noise) - 1;
        };
        CHECK(once.prediction[k] == paper.prediction[k]);
        CHECK(once.standard_deviation[k] == Approx(paper.standard_deviation[k]));
        CHECK(variance(often) == Approx(3 + 1e6F * variance(paper)).epsilon(0.05));
    }
    CHECK(std::abs(open.prediction[0] - arm.constants.output_offset[0]) <
          0.01F * std::abs(paper.prediction[0] - arm.constants.output_offset[0]));
    CHECK(open.prediction[1] == often.prediction[1]);
}

TEMPLATE_TEST_CASE(
    "far from the data the prediction equals the physics and the deviation is that of the output", "",
    Features, Mean, Kernel) {
    DFDYN_SEEDED_ENGINE(engine);
    StrayArm<TestType> arm(engine);
    float strayed = 0;
    for (int visit = 0; visit < 20; ++visit) {
        const auto estimate = arm.estimate_at(6);
        REQUIRE(estimate.status.predicted());
        strayed = std::max(strayed, std::abs(estimate.prediction[0] - arm.without_features(0)));
    }
    // The features of the paper contribute at this position.
    REQUIRE(strayed > arm.constants.output_noise_std[0]);
    arm.know();
    for (int visit = 0; visit < 20; ++visit) {
        const auto estimate = arm.estimate_at(6);
        REQUIRE(estimate.status.predicted());
        CHECK(std::abs(estimate.prediction[0] - arm.without_features(0)) < 0.2F * strayed);
        for (int k = 0; k < 2; ++k) {
            const float noise = arm.constants.output_noise_std[k];
            const float prior = arm.constants.extrapolation.prior_variance[k];
            CHECK(estimate.standard_deviation[k] > 0.9F * noise * std::sqrt(prior));
        }
    }
}

TEMPLATE_TEST_CASE("near the data predictions do not change", "", Features, Mean, Kernel) {
    DFDYN_SEEDED_ENGINE(engine);
    StrayArm<TestType> arm(engine);
    for (int visit = 0; visit < 20; ++visit) {
        arm.constants.extrapolation = {};
        arm.now = 1000 + 50 * visit; // within the learned motion
        const auto before = arm.estimate_at(0);
        arm.know();
        arm.now = 1000 + 50 * visit;
        const auto after = arm.estimate_at(0);
        for (int k = 0; k < 2; ++k) {
            CHECK(std::abs(after.prediction[k] - before.prediction[k]) <
                  0.1F * arm.constants.output_noise_std[k]);
            CHECK(after.standard_deviation[k] >= arm.constants.output_noise_std[k]);
        }
    }
}

// The covariance describes only the samples since the change, but the weights are still the best estimate
// elsewhere.
TEST_CASE("after a change the model keeps its predictions at positions not visited since") {
    DFDYN_SEEDED_ENGINE(engine);
    StrayArm<Features> arm(engine);
    arm.know();
    arm.now = 2900; // within the learned motion
    const auto before = arm.estimate_at(0);
    arm.now = 3100;
    arm.estimator.restart_window();
    for (int t = 0; t < 30; ++t) {
        auto sample = arm.due();
        sample.output[1] += 50;
        arm.tick(sample);
    }
    arm.now = 2900;
    const auto after = arm.estimate_at(0);
    CHECK(after.standard_deviation[0] > 2 * before.standard_deviation[0]);
    CHECK(std::abs(after.prediction[0] - before.prediction[0]) < 3 * arm.constants.output_noise_std[0]);
}

} // namespace extrapolation_test
