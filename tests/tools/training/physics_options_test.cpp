// SPDX-License-Identifier: Apache-2.0
// Cross validation, threads and options of training with physics.
#include "tests/support/catch.hpp"
#include "tests/tools/training/physics_arm.hpp"
#include "tools/training/search/training_setup.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <string>

namespace train_physics_test {

bool same(const tools::TrainingResult& a, const tools::TrainingResult& b) {
    return a.model.start.weights == b.model.start.weights &&
           a.model.outputs.noise_std == b.model.outputs.noise_std &&
           a.physics->start.parameters == b.physics->start.parameters &&
           a.physics->start.diagonal == b.physics->start.diagonal &&
           a.physics->motion_rows == b.physics->motion_rows;
}

TEST_CASE("cross validation fills the model and reports its grid") {
    const Structure* const model = GENERATE(&structures::NP, &structures::P, &structures::SP2);
    const auto input = GENERATE(InputKind::STD, InputKind::DF, InputKind::DFSR);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(model->name, static_cast<int>(input));
    Arm arm;
    arm.options.model = model;
    arm.options.hyper = HyperMethod::CV;
    arm.options.input = input;
    const tools::TrainingResult result = tools::train(arm.data, arm.options);
    CHECK(result.model.training.method == "CV");
    const auto best = std::min_element(result.hold_out.begin(), result.hold_out.end(),
                                       [](const auto& a, const auto& b) { return a.error < b.error; });
    REQUIRE(best != result.hold_out.end());
    if (model == &structures::P) {
        CHECK(result.physics->prior_variance > 0);
    } else {
        CHECK(result.model.features.length_scale == Approx(best->length_scale));
        CHECK(result.model.outputs.prior_variance == Approx(1 / best->noise_ratio));
    }
    if (model != &structures::NP) {
        const tools::RowList rows = dfdyn::tests::rows_between(lags, 500);
        CHECK(relative_error(predictions(arm, result, arm.data, rows), arm.data.outputs(rows, Eigen::all)) <
              0.5);
    }
}

TEST_CASE("cross validation selects the point with the smallest hold-out error") {
    const auto input = GENERATE(InputKind::STD, InputKind::DF, InputKind::DFSR);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(static_cast<int>(input));
    Arm arm;
    arm.options.hyper = HyperMethod::CV;
    arm.options.input = input;
    const tools::TrainingResult result = tools::train(arm.data, arm.options);
    const double length_scale = result.model.features.length_scale;
    const double noise_ratio = 1 / result.model.outputs.prior_variance;
    const tools::TrainingSetup setup(arm.data, arm.options);
    const MatrixXd inputs = tools::stored_inputs(result.model.input, arm.data, setup.rows.likelihood);
    MatrixXd outputs = arm.data.outputs(setup.rows.likelihood, Eigen::all);
    outputs.rowwise() -= Eigen::RowVector2d(result.model.outputs.offset.data());
    const Index seen = 105; // of 150
    MatrixXd kernel(150, 150);
    for (Index s = 0; s < 150; ++s) {
        const VectorXd squares = (inputs.rowwise() - inputs.row(s)).rowwise().squaredNorm();
        kernel.col(s) = (-squares / (2 * length_scale * length_scale)).array().exp();
    }
    const MatrixXd noisy = kernel.topLeftCorner(seen, seen) + noise_ratio * MatrixXd::Identity(seen, seen);
    const MatrixXd predicted =
        kernel.bottomLeftCorner(150 - seen, seen) * noisy.partialPivLu().solve(outputs.topRows(seen));
    const MatrixXd measured = outputs.bottomRows(150 - seen);
    const MatrixXd centred = measured.rowwise() - measured.colwise().mean();
    const double error =
        ((predicted - measured).colwise().squaredNorm().array() / centred.colwise().squaredNorm().array())
            .mean();
    REQUIRE(result.hold_out.size() == 169);
    for (const tools::HoldOutPoint& point : result.hold_out) {
        CHECK(point.error >= error * (1 - 1e-6));
    }
    CHECK(tools::best_point(result.hold_out).error == Approx(error).epsilon(1e-6));
}

TEST_CASE("training with physics is deterministic for any number of threads") {
    const auto model = GENERATE(&structures::P, &structures::SP, &structures::SP2, &structures::SPK);
    CAPTURE(model->name);
    Arm arm;
    arm.options.model = model;
    const tools::TrainingResult first = tools::train(arm.data, arm.options);
    arm.options.threads = 1;
    CHECK(same(first, tools::train(arm.data, arm.options)));
}

TEST_CASE("inconsistent options are rejected") {
    Arm arm;
    arm.options.model = &structures::SPK;
    SECTION("no robot") {
        arm.options.physics.regressor = nullptr;
        CHECK(arm.message() == "training options: expected a robot's physics for model SPK, found none");
    }
    SECTION("a robot with other outputs") {
        const dfdyn::tests::SyntheticRegressor other(3, 6, 4, arm.random);
        arm.options.physics.regressor = &other;
        CHECK(arm.message() == "training options: expected physics of 2 outputs, found 6");
    }
    SECTION("rows that the physics cannot share") {
        arm.options.rows_per_joint = 2;
        CHECK(arm.message().empty());
        arm.options.physics.motion = dfdyn::tools::PhysicsMotion::of_input;
        CHECK(arm.message() ==
              "training options: expected at least 3 rows per joint for the physics to share, found 2");
    }
    SECTION("cross validation") {
        arm.options.hyper = HyperMethod::CV;
        CHECK(arm.message() ==
              "training options: expected model NP, P or SP2 for cross validation, found SPK");
        arm.options.model = &structures::P;
        CHECK(arm.message() ==
              "training options: expected input STD, DF or DFSR for cross validation, found DFR");
    }
    SECTION("given parameters") {
        arm.options.physics.given = VectorXd::Zero(6);
        CHECK(arm.message() == "training options: expected model SP2 for given parameters, found SPK");
        arm.options.model = &structures::SP2;
        arm.options.physics.given = VectorXd::Zero(5);
        CHECK(arm.message() == "training options: expected 6 finite physical parameters, found 5");
    }
    SECTION("threshold") {
        arm.options.physics.column_threshold = 1;
        CHECK(arm.message() ==
              "training options: expected a threshold of the columns between 0 and 1, found 1");
    }
    SECTION("lags") {
        arm.options.input = InputKind::DF;
        arm.options.lags = 1;
        CHECK(arm.message() == "training options: expected at least 2 lags, found 1");
    }
}

TEST_CASE("outputs whose squares overflow leave no start with a finite likelihood") {
    Arm arm;
    arm.options.model = GENERATE(&structures::P, &structures::SP, &structures::SPK);
    arm.data.outputs *= 1e200;
    CHECK(arm.message() ==
          "training: expected a finite likelihood from at least one of 2 starts, found none");
}

} // namespace train_physics_test
