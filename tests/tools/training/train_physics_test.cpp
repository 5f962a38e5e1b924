// SPDX-License-Identifier: Apache-2.0
#include "tools/training/train.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/support/all_inputs.hpp"
#include "tests/tools/training/physics_arm.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace train_physics_test {

/// A regressor with an additional column of rounding errors.
class WithRoundingColumn final : public tools::Regressor {
  public:
    explicit WithRoundingColumn(const tools::Regressor& exact) : exact_(exact) {}

    Index outputs() const override { return exact_.outputs(); }
    Index columns() const override { return exact_.columns() + 1; }

    void evaluate(const tools::MotionState& state, MatrixXd& values) const override {
        MatrixXd exact(outputs(), exact_.columns());
        exact_.evaluate(state, exact);
        values.leftCols(exact.cols()) = exact;
        for (Index k = 0; k < outputs(); ++k) {
            values(k, exact.cols()) = 1e-15 * std::sin(40 * state.position[0] + 3 * state.velocity[k]);
        }
    }

    tools::RegressorGradient pull_back(const tools::MotionState& state,
                                       const MatrixXd& gradient) const override {
        return exact_.pull_back(state, gradient.leftCols(exact_.columns()));
    }

  private:
    const tools::Regressor& exact_;
};

TEST_CASE("every model with every input predicts its training data from its stored numbers alone") {
    const auto model = GENERATE(&structures::P, &structures::SP, &structures::SP2, &structures::SPK);
    const auto input = GENERATE(from_range(dfdyn::tests::all_inputs()));
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(model->name, static_cast<int>(input));
    Arm arm;
    arm.options.model = model;
    arm.options.input = input;
    const tools::TrainingResult result = tools::train(arm.data, arm.options);
    REQUIRE(result.physics);
    const tools::TrainedPhysics& physics = *result.physics;
    const std::size_t p = physics.columns.size();
    CHECK(p == 6);
    CHECK(physics.column_scale.minCoeff() > 0);
    CHECK(physics.motion_rows.rows() == (input == InputKind::STD ? 0 : 3));
    const bool learned = model == &structures::P || model == &structures::SPK;
    CHECK(physics.start.diagonal.size() == (learned ? p : 0));
    CHECK(physics.start.coupling.size() == (model == &structures::SPK ? 2 : 0));
    CHECK((physics.prior_variance > 0) == learned);
    CHECK(result.model.start.weights.size() == (model == &structures::P ? 0 : 2 * 120));
    CHECK(result.model.outputs.offset == std::vector<double>{0, 0});
    const tools::RowList rows = dfdyn::tests::rows_between(lags, 500);
    const double error =
        relative_error(predictions(arm, result, arm.data, rows), arm.data.outputs(rows, Eigen::all));
    CHECK(error < (model == &structures::P ? 0.5 : 0.1));
    if (model == &structures::P) {
        CHECK(error > 0.02); // the model has no friction
    }
}

TEST_CASE("physics lets the models predict motions beyond their training data") {
    const auto input = GENERATE(InputKind::STD, InputKind::DFR, InputKind::DFSR);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(static_cast<int>(input));
    Arm arm;
    arm.options.input = input;
    const tools::TrainingData beyond = arm.widened(2);
    const tools::RowList rows = dfdyn::tests::rows_between(lags, 500);
    const MatrixXd truth = beyond.outputs(rows, Eigen::all);
    const double nonparametric =
        relative_error(predictions(arm, tools::train(arm.data, arm.options), beyond, rows), truth);
    CHECK(nonparametric > 0.3); // the training data contain nothing similar
    for (const Structure* const model :
         {&structures::P, &structures::SP, &structures::SP2, &structures::SPK}) {
        CAPTURE(model->name);
        arm.options.model = model;
        const auto result = tools::train(arm.data, arm.options);
        CHECK(relative_error(predictions(arm, result, beyond, rows), truth) < 0.5 * nonparametric);
    }
}

TEST_CASE("physical parameters are correct if the physics is") {
    const auto model = GENERATE(&structures::SP, &structures::SPK);
    const auto prior = GENERATE(tools::PriorForm::scaled, tools::PriorForm::unit, tools::PriorForm::diagonal);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(model->name, static_cast<int>(prior));
    Arm arm;
    arm.options.model = model;
    arm.options.input = InputKind::STD;
    arm.options.physics.prior = prior;
    const tools::TrainingResult result = tools::train(arm.data, arm.options);
    const VectorXd physical = result.physics->column_scale.cwiseProduct(result.physics->start.parameters);
    CHECK((physical - arm.truth).norm() < 0.35 * arm.truth.norm());
    if (prior == tools::PriorForm::unit) {
        CHECK(result.physics->column_scale == VectorXd::Ones(6));
    }
    if (prior == tools::PriorForm::diagonal && model == &structures::SPK) {
        CHECK(result.physics->prior_variance == 1);
    }
}

TEST_CASE("a column of rounding errors never becomes a parameter") {
    const auto model = GENERATE(&structures::P, &structures::SP, &structures::SP2, &structures::SPK);
    const auto prior = GENERATE(tools::PriorForm::scaled, tools::PriorForm::unit, tools::PriorForm::diagonal);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(model->name, static_cast<int>(prior));
    Arm arm;
    const WithRoundingColumn regressor(arm.regressor);
    arm.options.physics.regressor = &regressor;
    arm.options.physics.prior = prior;
    arm.options.model = model;
    arm.options.input = InputKind::STD;
    arm.options.starts = 1;
    const tools::TrainingResult result = tools::train(arm.data, arm.options);
    CHECK(std::ranges::count(result.physics->columns, 6) == 0);
    CHECK(result.physics->columns.size() == 6);
}

TEST_CASE("the prior deviation of a parameter is at most the size that a machine can have") {
    const auto model = GENERATE(&structures::P, &structures::SPK);
    const auto prior = GENERATE(tools::PriorForm::scaled, tools::PriorForm::unit, tools::PriorForm::diagonal);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(model->name, static_cast<int>(prior));
    Arm arm;
    arm.options.model = model;
    arm.options.input = InputKind::STD;
    arm.options.physics.prior = prior;
    const auto deviations = [&] {
        const tools::TrainedPhysics physics = *tools::train(arm.data, arm.options).physics;
        return VectorXd(std::sqrt(physics.prior_variance) * physics.column_scale);
    };
    const VectorXd free = deviations();
    const double size = 0.5 * free.maxCoeff();
    arm.options.physics.parameter_size = VectorXd::Constant(6, size);
    const VectorXd bounded = deviations();
    REQUIRE(bounded.size() == 6);
    CHECK(bounded.maxCoeff() == Approx(size));
    for (Index c = 0; c < 6; ++c) {
        CHECK(bounded[c] == Approx(std::min(free[c], size)));
    }
}

TEST_CASE("the columns of the physics are of order one in units of the noise") {
    Arm arm;
    arm.options.model = &structures::SPK;
    arm.options.input = InputKind::STD;
    const tools::TrainingResult result = tools::train(arm.data, arm.options);
    const MatrixXd columns =
        tools::all_columns(arm.regressor, {arm.data.positions, arm.data.velocities, arm.data.accelerations});
    for (Index c = 0; c < 6; ++c) {
        const double first = columns.col(c).norm() / result.model.outputs.noise_std[0];
        const double second = columns.col(6 + c).norm() / result.model.outputs.noise_std[1];
        const double size = result.physics->column_scale[c] * std::hypot(first, second) / std::sqrt(1000);
        CHECK(size > 0.3);
        CHECK(size < 3);
    }
}

TEST_CASE("the physics of DFR can have its own filters") {
    const auto model = GENERATE(&structures::SP2, &structures::SPK);
    const auto motion = GENERATE(tools::PhysicsMotion::free, tools::PhysicsMotion::poles);
    CAPTURE(model->name, static_cast<int>(motion));
    Arm arm;
    arm.options.model = model;
    arm.options.physics.motion = motion;
    arm.options.rows_per_joint = 2; // without an acceleration
    const tools::TrainingResult result = tools::train(arm.data, arm.options);
    const MatrixXd& rows = result.physics->motion_rows;
    // A constant position has no velocity or acceleration.
    CHECK(rows.bottomRows(2).rowwise().sum().norm() < 1e-8 * rows.norm());
    const VectorXd time = -arm.data.sample_period_s * VectorXd::LinSpaced(lags + 1, 0, lags);
    CHECK(rows.row(1).dot(time) == Approx(1));
    CHECK(rows.row(2).dot(time.cwiseAbs2() / 2) == Approx(1));
    CHECK(result.model.input.rows_per_joint == 2);
}

TEST_CASE("SP2 uses given parameters") {
    Arm arm;
    arm.options.model = &structures::SP2;
    arm.options.hyper = GENERATE(HyperMethod::ML, HyperMethod::CV);
    arm.options.input = InputKind::STD;
    arm.options.physics.given = arm.truth;
    const tools::TrainingResult result = tools::train(arm.data, arm.options);
    const VectorXd physical = result.physics->column_scale.cwiseProduct(result.physics->start.parameters);
    CHECK((physical - arm.truth).norm() < 1e-9);
    CHECK(result.physics->columns.size() == 6);
}

TEST_CASE("DFR has at least the likelihood of DFSR") {
    // Without filters of its own, the prior of SPK has different units for the two inputs.
    using tools::PhysicsMotion;
    const auto [model, motion] =
        GENERATE(table<const Structure*, PhysicsMotion>({{&structures::NP, PhysicsMotion::free},
                                                         {&structures::SPK, PhysicsMotion::free},
                                                         {&structures::SPK, PhysicsMotion::poles},
                                                         {&structures::SP, PhysicsMotion::of_input}}));
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(model->name, static_cast<int>(motion));
    Arm arm;
    arm.options.model = model;
    arm.options.physics.motion = motion;
    arm.options.input = InputKind::DFSR;
    const double structured = tools::train(arm.data, arm.options).model.training.log_likelihood;
    arm.options.input = InputKind::DFR;
    arm.options.starts = 1;
    CHECK(tools::train(arm.data, arm.options).model.training.log_likelihood >=
          // The tolerance is the search's; the filters are truncated differently.
          structured - (motion == PhysicsMotion::of_input ? 1e-3 : 1e-6));
}

} // namespace train_physics_test
