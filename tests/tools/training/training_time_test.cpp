// SPDX-License-Identifier: Apache-2.0
// Duration of training with the default effort.
#include "tests/support/catch.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tests/tools/training/synthetic_physics.hpp"
#include "tools/model/structure.hpp"
#include "tools/training/train.hpp"

#include <chrono>

namespace tools = dfdyn::tools;

TEST_CASE("a thousand samples of six outputs train in two minutes on two threads", "[.long]") {
    const auto model = GENERATE(&tools::structures::NP, &tools::structures::SPK);
    tools::NormalSource random(1);
    const tools::TrainingData data = dfdyn::tests::arm_data(3000, 6, 6, random);
    const dfdyn::tests::SyntheticRegressor regressor(6, 6, 40, random);
    tools::TrainingOptions options; // DFR, k = 3, M = 10, six starts
    options.model = model;
    options.physics.regressor = &regressor;
    options.likelihood_rows = 1000;
    options.threads = 2;
    const auto begin = std::chrono::steady_clock::now();
    const tools::TrainingResult result = tools::train(data, options);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    CHECK(result.model.training.likelihood_rows == 1000);
    WARN("model " << result.model.structure << ": " << seconds << " s");
    CHECK(seconds < 120);
}
