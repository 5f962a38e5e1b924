// SPDX-License-Identifier: Apache-2.0
// Away from the data the features' part of a prediction fades out, and its standard deviation grows.
#include "dfdyn/estimator.hpp"

#include "tests/firmware_lib/support/running_arm.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace extrapolation_test {

using namespace dfdyn;
using namespace dfdyn::tests;

using Features = TestModel<float, DerivativeFreeReduced<6, 3>, 60>;
using Mean = TestMean<float, DerivativeFreeReduced<6, 3>, 60>;
using Kernel = TestKernel<float, DerivativeFreeReduced<6, 3>, 60>;

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

/// An arm that has learned 3,000 samples, and now stands where it never was.
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
        return constants;
    }

    /// Uses what `dfdyn train` would measure.
    void know() {
        this->constants.extrapolation.inverse_far_variance = inverse_far_variance(this->estimator);
        this->constants.extrapolation.extra_noise = {{0.5F, 0.5F}};
        this->constants.extrapolation.prior_variance = {{900, 400}};
    }

    /// The estimate `offset` rad away from where the arm would be, without learning it.
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

    /// What the physics alone says there, in the output's unit.
    float without_features(int k) {
        std::array<float, 2> means{};
        this->estimator.regression().predict_without_features(means.data());
        const auto output = static_cast<std::size_t>(k);
        return this->constants.output_offset[k] + this->constants.output_noise_std[k] * means[output];
    }
};

TEST_CASE("doubt rises from nothing at the data to nearly all far from them") {
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
    CHECK(Extrapolation<float>(1, 1).variance(6, 1, 0.5F, 7) == 12.5F); // 4 of the physics' parameters
}

TEST_CASE("without the constants predictions and standard deviations are the paper's, bit for bit") {
    const Extrapolation<float> paper(123.4F, 0);
    CHECK(paper.doubt() == 0);
    CHECK(paper.variance(124.4F, 123.4F, 0, 0) == 124.4F);
}

TEMPLATE_TEST_CASE("far from the data the physics predicts, or the mean, and the deviation is the output's",
                   "", Features, Mean, Kernel) {
    DFDYN_SEEDED_ENGINE(engine);
    StrayArm<TestType> arm(engine);
    float strayed = 0;
    for (int visit = 0; visit < 20; ++visit) {
        const auto estimate = arm.estimate_at(6);
        REQUIRE(estimate.status.predicted());
        strayed = std::max(strayed, std::abs(estimate.prediction[0] - arm.without_features(0)));
    }
    REQUIRE(strayed > arm.constants.output_noise_std[0]); // the paper's features say something there
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

TEMPLATE_TEST_CASE("near the data predictions stay as they are", "", Features, Mean, Kernel) {
    DFDYN_SEEDED_ENGINE(engine);
    StrayArm<TestType> arm(engine);
    for (int visit = 0; visit < 20; ++visit) {
        arm.constants.extrapolation = {};
        arm.now = 1000 + 50 * visit; // where it has been
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

} // namespace extrapolation_test
