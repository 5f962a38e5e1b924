// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/train_outcome.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"
#include "tests/tools/sizing/sized_model.hpp"

#include <cmath>
#include <random>
#include <sstream>

namespace train_outcome_test {

using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::run_program;
using dfdyn::tests::TemporaryDirectory;
using dfdyn::tools::bounds_reached;
using dfdyn::tools::TrainedModel;

TEST_CASE("each bound of the search that the kernel reached is named, and no other") {
    TrainedModel model = dfdyn::tests::sized_model(2, 2, 4, 3, 10);
    model.features.length_scale = 3;
    model.outputs.prior_variance = 500;
    CHECK(bounds_reached(model).empty());

    model.features.length_scale = 0.01;
    CHECK_THAT(bounds_reached(model).at(0), ContainsSubstring("length scale is at its lower bound"));
    model.features.length_scale = 999.9;
    CHECK_THAT(bounds_reached(model).at(0), ContainsSubstring("length scale is at its upper bound"));
    model.features.length_scale = 980;
    model.outputs.prior_variance = 1e6;
    CHECK_THAT(bounds_reached(model).at(0), ContainsSubstring("rho^2/sigma^2 is at its upper bound"));
    CHECK(bounds_reached(model).size() == 1);
    model.outputs.prior_variance = 0.01;
    CHECK_THAT(bounds_reached(model).at(0), ContainsSubstring("rho^2/sigma^2 is at its lower bound"));

    TrainedModel without_features = model;
    without_features.structure = "P";
    CHECK(bounds_reached(without_features).empty());
}

TEST_CASE("training on outputs that are only noise says that the features explain hardly anything") {
    const TemporaryDirectory directory;
    std::mt19937 engine(3);
    std::normal_distribution<double> noise;
    std::ostringstream csv("t,q1,q2,tau1,tau2\n", std::ios::ate);
    for (int row = 0; row < 1500; ++row) {
        const double time_s = 0.01 * row;
        csv << time_s << ',' << std::sin(time_s) << ',' << std::cos(1.7 * time_s) << ',' << noise(engine)
            << ',' << noise(engine) << '\n';
    }
    directory.write("noise.csv", csv.str());
    const auto outcome = run_program(
        directory, "train --outputs tau --features 10 --starts 1 --likelihood-rows 200 --quiet --log " +
                       (directory.path() / "noise.csv").string() + " -o " +
                       (directory.path() / "model.json").string());
    CHECK(outcome.status == 0);
    CHECK_THAT(outcome.out, ContainsSubstring("the features explain hardly anything"));
}

} // namespace train_outcome_test
