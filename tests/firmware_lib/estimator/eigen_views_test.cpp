// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/eigen.hpp"

#include "dfdyn/estimator.hpp"
#include "dfdyn/learner/ud_covariance.hpp"
#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cstdint>

namespace eigen_views_test {

using namespace dfdyn;
using namespace dfdyn::tests;

TEST_CASE("a view of a sample reads and writes the sample's own numbers") {
    Sample<float, 3, 2> sample{};
    view(sample.position) = Eigen::Vector3f(1, 2, 3);
    CHECK(sample.position[1] == 2);
    const Sample<float, 3, 2>& constant = sample;
    CHECK(view(constant.position).data() == constant.position.data());
    CHECK(view(constant.output).size() == 2);
}

using UdFloat = TestModel<float>;

TEMPLATE_TEST_CASE("a view of the weights has one row per output for any stride", "", UdFloat) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<TestType>(engine);
    Estimator<TestType> estimator(constants);
    for (std::int64_t tick = 0; tick < 40; ++tick) {
        estimator.tick(moving_sample<TestType>(tick, engine), Budget::unlimited());
    }
    const auto weights = view_weights(estimator.regression().learner());
    const auto copied = weights_of(estimator);
    REQUIRE(weights.norm() > 0);
    REQUIRE(weights.size() == static_cast<Eigen::Index>(copied.size()));
    for (Eigen::Index output = 0; output < weights.rows(); ++output) {
        for (Eigen::Index column = 0; column < weights.cols(); ++column) {
            CHECK(weights(output, column) ==
                  copied[static_cast<std::size_t>(output * weights.cols() + column)]);
        }
    }
}

} // namespace eigen_views_test
