// SPDX-License-Identifier: Apache-2.0
#include "tools/training/train.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tests/tools/training/synthetic_physics.hpp"
#include "tools/base/text/error.hpp"
#include "tools/model/structure.hpp"
#include "tools/training/data/input_map.hpp"
#include "tools/training/data/lag_window.hpp"
#include "tools/training/physics/physics_columns.hpp"
#include "tools/training/search/training_problem.hpp"
#include "tools/training/start/random_features.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <string>

namespace train_physics_test {

namespace tools = dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using tools::HyperMethod;
using tools::InputKind;
using tools::Structure;
namespace structures = tools::structures;

constexpr int lags = 5;

/// An arm of three joints with two outputs: physics of six columns, friction that is not among them, and
/// noise.
struct Arm {
    tools::NormalSource random{dfdyn::tests::seed()};
    tools::TrainingData data = dfdyn::tests::arm_data(500, 3, 2, random);
    dfdyn::tests::SyntheticRegressor regressor{3, 2, 6, random};
    VectorXd truth{{2, -1, 3, 1.5, -2, 1}};
    tools::TrainingOptions options;

    Arm() {
        data.outputs = outputs_of(data);
        options.lags = lags;
        options.feature_count = 60;
        options.likelihood_rows = 150;
        options.starts = 2;
        options.evaluations_per_start = 40;
        options.refinement_evaluations = 5;
        options.physics.regressor = &regressor;
    }

    MatrixXd outputs_of(const tools::TrainingData& motion) {
        const MatrixXd columns =
            tools::all_columns(regressor, {motion.positions, motion.velocities, motion.accelerations});
        MatrixXd outputs(500, 2);
        for (Index k = 0; k < 2; ++k) {
            outputs.col(k) = columns.middleCols(6 * k, 6) * truth +
                             (3 * motion.velocities.col(k)).array().tanh().matrix() +
                             0.05 * random.matrix(500, 1);
        }
        return outputs;
    }

    /// The same motion with `factor` times the amplitude.
    tools::TrainingData widened(double factor) {
        tools::TrainingData wide = data;
        wide.positions *= factor;
        wide.velocities *= factor;
        wide.accelerations *= factor;
        wide.outputs = outputs_of(wide);
        return wide;
    }

    std::string message() const {
        try {
            tools::train(data, options);
        } catch (const tools::InputError& error) {
            return error.what();
        }
        return "";
    }
};

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

/// Predictions for the rows `rows` of `data` by the firmware's formulas, from the stored numbers alone.
MatrixXd predictions(const Arm& arm, const tools::TrainingResult& result, const tools::TrainingData& data,
                     const tools::RowList& rows) {
    const tools::TrainedModel& model = result.model;
    const tools::TrainedPhysics physics = result.physics.value_or(tools::TrainedPhysics{});
    tools::MotionSamples motion{data.positions(rows, Eigen::all), data.velocities(rows, Eigen::all),
                                data.accelerations(rows, Eigen::all)};
    if (physics.motion_rows.size() > 0) {
        const MatrixXd windows = tools::lag_windows(data.positions, rows, lags);
        for (Index joint = 0; joint < 3; ++joint) {
            const auto window = windows.middleCols(joint * (lags + 1), lags + 1);
            motion.positions.col(joint) = window * physics.motion_rows.row(0).transpose();
            motion.velocities.col(joint) = window * physics.motion_rows.row(1).transpose();
            motion.accelerations.col(joint) = window * physics.motion_rows.row(2).transpose();
        }
    }
    const MatrixXd columns = tools::all_columns(arm.regressor, motion);
    const VectorXd& pi = physics.start.parameters;
    MatrixXd result_matrix(columns.rows(), 2);
    for (Index k = 0; k < 2; ++k) {
        const double noise = model.outputs.noise_std[static_cast<std::size_t>(k)];
        VectorXd scaled = VectorXd::Zero(columns.rows());
        for (Index c = 0; c < pi.size(); ++c) {
            const Index column = 6 * k + physics.columns[static_cast<std::size_t>(c)];
            scaled += columns.col(column) * (physics.column_scale[c] / noise * pi[c]);
        }
        if (model.features.count > 0) {
            const Index size = 2 * model.features.count;
            VectorXd weights = Eigen::Map<const VectorXd>(model.start.weights.data() + k * size, size);
            if (!physics.start.coupling.empty()) {
                weights -= physics.start.coupling[static_cast<std::size_t>(k)] * pi;
            }
            scaled += tools::random_features(model.features, tools::stored_inputs(model.input, data, rows)) *
                      weights;
        }
        result_matrix.col(k) = model.outputs.offset[static_cast<std::size_t>(k)] + (noise * scaled).array();
    }
    return result_matrix;
}

double relative_error(const MatrixXd& predicted, const MatrixXd& measured) {
    const MatrixXd centred = measured.rowwise() - measured.colwise().mean();
    return (predicted - measured).norm() / centred.norm();
}

bool same(const tools::TrainingResult& a, const tools::TrainingResult& b) {
    return a.model.start.weights == b.model.start.weights &&
           a.model.outputs.noise_std == b.model.outputs.noise_std &&
           a.physics->start.parameters == b.physics->start.parameters &&
           a.physics->start.diagonal == b.physics->start.diagonal &&
           a.physics->motion_rows == b.physics->motion_rows;
}

TEST_CASE("every model with every input predicts its training data from its stored numbers alone") {
    const auto model = GENERATE(&structures::P, &structures::SP, &structures::SP2, &structures::SPK);
    const auto input =
        GENERATE(InputKind::STD, InputKind::DF, InputKind::DFW, InputKind::DFR, InputKind::DFSR);
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
    Arm arm;
    arm.options.model = model;
    arm.options.physics.own_motion = true;
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

TEST_CASE("the likelihood of DFR is at least that of DFSR") {
    // Without filters of its own, the prior of SPK has different units for the two inputs.
    const auto [model, own_motion] = GENERATE(table<const Structure*, bool>(
        {{&structures::NP, true}, {&structures::SPK, true}, {&structures::SP, false}}));
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(model->name, own_motion);
    Arm arm;
    arm.options.model = model;
    arm.options.physics.own_motion = own_motion;
    arm.options.input = InputKind::DFSR;
    const double structured = tools::train(arm.data, arm.options).model.training.log_likelihood;
    arm.options.input = InputKind::DFR;
    arm.options.starts = 1;
    CHECK(tools::train(arm.data, arm.options).model.training.log_likelihood >=
          // The tolerance is that of the search; the filters are truncated differently.
          structured - (own_motion ? 1e-6 : 1e-3));
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
