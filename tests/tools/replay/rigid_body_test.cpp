// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/replay/opponents/rigid_body.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/regressor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rigid_body_test {

using namespace dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double gravity = 9.81;
constexpr double sign_velocity = 0.05;
constexpr double period_s = 0.008;

/// Two joints that each move along a sum of two sines of random frequency and phase.
class TwoJointMotion {
  public:
    explicit TwoJointMotion(std::mt19937_64& engine) {
        std::uniform_real_distribution<double> rate(0.7, 3);
        std::uniform_real_distribution<double> phase(0, 6);
        for (Sine& sine : sines_) {
            sine = {rate(engine), phase(engine)};
        }
    }

    /// Derivative of order 0, 1 or 2 of the joint's position.
    double at(std::size_t joint, double t, int derivative) const {
        double sum = 0;
        for (const Sine& sine : {sines_[2 * joint], sines_[2 * joint + 1]}) {
            sum += 0.8 * std::pow(sine.rate, derivative) *
                   std::sin(sine.rate * t + sine.phase + derivative * 1.5707963267948966);
        }
        return sum;
    }

  private:
    struct Sine {
        double rate, phase;
    };
    std::array<Sine, 4> sines_{};
};

/// Positions, velocities and accelerations of a motion, without outputs.
Recording recording_of(const TwoJointMotion& motion, int rows) {
    Recording recording;
    recording.source = "run.csv";
    recording.position.names = {"q1", "q2"};
    recording.velocity.names = {"qd1", "qd2"};
    recording.acceleration.names = {"qdd1", "qdd2"};
    recording.output.names = {"tau1", "tau2"};
    for (int row = 0; row < rows; ++row) {
        const double t = period_s * row;
        recording.time_s.push_back(t);
        recording.time_ns.push_back(std::llround(1e9 * t));
        recording.gap_before.push_back(row == 0 ? 1 : 0);
        for (const std::size_t joint : {0U, 1U}) {
            recording.position.values.push_back(motion.at(joint, t, 0));
            recording.velocity.values.push_back(motion.at(joint, t, 1));
            recording.acceleration.values.push_back(motion.at(joint, t, 2));
        }
    }
    recording.output.values.resize(recording.position.values.size());
    return recording;
}

/// Textbook equations of the planar arm with links of length 1. Both torques are linear in the inertia about
/// the joint and the first moments of each link; the first link includes the mass of the second at its end.
Eigen::Matrix<double, 2, 6> planar_columns(const Recording& recording, std::size_t row) {
    const auto q = recording.position.row(row);
    const auto v = recording.velocity.row(row);
    const auto a = recording.acceleration.row(row);
    const double c2 = std::cos(q[1]), s2 = std::sin(q[1]);
    const double c12 = gravity * std::cos(q[0] + q[1]), s12 = gravity * std::sin(q[0] + q[1]);
    const double coriolis = 2 * v[0] * v[1] + v[1] * v[1];
    Eigen::Matrix<double, 2, 6> columns;
    columns << a[0], gravity * std::cos(q[0]), -gravity * std::sin(q[0]), a[0] + a[1],
        2 * c2 * a[0] + c2 * a[1] - s2 * coriolis + c12, -2 * s2 * a[0] - s2 * a[1] - c2 * coriolis - s12, //
        0, 0, 0, a[0] + a[1], c2 * a[0] + s2 * v[0] * v[0] + c12, -s2 * a[0] + c2 * v[0] * v[0] - s12;
    return columns;
}

/// Parameters of planar_arm(): each link has 1 kg at (0.5, 0.1) m and 0.1 kg·m² about its centre of mass.
VectorXd planar_parameters() {
    VectorXd parameters(6);
    parameters << 0.36 + 1, 0.5 + 1, 0.1, 0.36, 0.5, 0.1;
    return parameters;
}

/// Viscous friction, dry friction and an offset of a joint.
Eigen::RowVector3d friction_columns(const Recording& recording, std::size_t row, std::size_t joint) {
    const double velocity = recording.velocity.row(row)[joint];
    return {velocity, std::tanh(velocity / sign_velocity), 1};
}

/// Adds the torques of another planar arm with friction, and noise of different sizes.
void measure(Recording& recording, double noise, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    VectorXd inertia = planar_parameters();
    inertia += 0.2 * VectorXd::LinSpaced(6, -1, 1);
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        const Eigen::Vector2d torque = planar_columns(recording, row) * inertia;
        for (const std::size_t joint : {0U, 1U}) {
            const Eigen::Vector3d friction(0.7, 1.5, joint == 0 ? 0.3 : -0.4);
            recording.output.values[2 * row + joint] = torque[static_cast<Index>(joint)] +
                                                       friction_columns(recording, row, joint).dot(friction) +
                                                       noise * (joint == 0 ? 1 : 0.1) * normal(engine);
        }
    }
}

/// `gain`: output per N·m of both joints.
std::vector<RigidBodyFit> fit_planar(const Recording& recording, double gain = 1) {
    const Robot robot = dfdyn::tests::planar_arm(gravity);
    return fit_rigid_body(robot, chain_model(robot, OutputKind::joint_torque), {gain, gain}, sign_velocity,
                          {&recording, 1});
}

Forecasts forecasts_of(const RigidBodyFit& fit, const Recording& recording) {
    return rigid_body_forecasts(fit, chain_model(dfdyn::tests::planar_arm(gravity), OutputKind::joint_torque),
                                recording);
}

/// Rows of both joints: [columns of the inertia, friction of joint 1, friction of joint 2].
MatrixXd joint_rows(const Recording& recording, std::size_t joint) {
    MatrixXd rows = MatrixXd::Zero(static_cast<Index>(recording.row_count()), 12);
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        const auto at = static_cast<Index>(row);
        rows.row(at).head<6>() = planar_columns(recording, row).row(static_cast<Index>(joint));
        rows.row(at).segment<3>(6 + 3 * static_cast<Index>(joint)) = friction_columns(recording, row, joint);
    }
    return rows;
}

VectorXd measured(const Recording& recording, std::size_t joint) {
    VectorXd values(static_cast<Index>(recording.row_count()));
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        values[static_cast<Index>(row)] = recording.output.row(row)[joint];
    }
    return values;
}

/// Least squares of all parameters by one QR decomposition, with the rows of each joint divided by its
/// deviation.
VectorXd weighted_solution(const Recording& recording, const std::array<double, 2>& deviation) {
    const auto rows = static_cast<Index>(recording.row_count());
    MatrixXd columns(2 * rows, 12);
    VectorXd right(2 * rows);
    columns << joint_rows(recording, 0) / deviation[0], joint_rows(recording, 1) / deviation[1];
    right << measured(recording, 0) / deviation[0], measured(recording, 1) / deviation[1];
    return least_squares(columns, right);
}

std::array<double, 2> left_over(const Recording& recording, const VectorXd& parameters) {
    return {(joint_rows(recording, 0) * parameters - measured(recording, 0)).norm(),
            (joint_rows(recording, 1) * parameters - measured(recording, 1)).norm()};
}

TEST_CASE("the identified rigid body is the least-squares solution of the textbook equations") {
    DFDYN_SEEDED_ENGINE(engine);
    Recording training = recording_of(TwoJointMotion(engine), 700);
    measure(training, 0.5, engine);
    const VectorXd first = weighted_solution(training, left_over(training, VectorXd::Zero(12)));
    const VectorXd truth = weighted_solution(training, left_over(training, first));
    const std::vector<RigidBodyFit> fits = fit_planar(training);
    REQUIRE(fits.size() == 2);
    REQUIRE(fits[1].identified);
    const Recording other = recording_of(TwoJointMotion(engine), 200);
    const Forecasts forecasts = forecasts_of(fits[1], other);
    for (const std::size_t joint : {0U, 1U}) {
        const VectorXd expected = joint_rows(other, joint) * truth;
        for (std::size_t row = 0; row < other.row_count(); ++row) {
            REQUIRE(forecasts[2 * row + joint] ==
                    Approx(expected[static_cast<Index>(row)]).epsilon(1e-8).margin(1e-8));
        }
    }
}

TEST_CASE("with the inertia of the robot's file gain and friction are each joint's least-squares solution") {
    DFDYN_SEEDED_ENGINE(engine);
    Recording training = recording_of(TwoJointMotion(engine), 700);
    measure(training, 0.5, engine);
    const std::vector<RigidBodyFit> fits = fit_planar(training);
    REQUIRE(fits.size() == 2);
    REQUIRE_FALSE(fits[0].identified);
    for (const std::size_t joint : {0U, 1U}) {
        const MatrixXd rows = joint_rows(training, joint);
        MatrixXd columns(rows.rows(), 4);
        columns << rows.leftCols<6>() * planar_parameters(),
            rows.middleCols<3>(6 + 3 * static_cast<Index>(joint));
        const VectorXd truth = least_squares(columns, measured(training, joint));
        CHECK(fits[0].output_gain[joint] == Approx(truth[0]).epsilon(1e-8));
        for (std::size_t term = 0; term < 3; ++term) {
            CHECK(fits[0].friction[3 * joint + term] ==
                  Approx(truth[1 + static_cast<Index>(term)]).epsilon(1e-7).margin(1e-9));
        }
    }
}

TEST_CASE("a wrench is forecast from the part of the arm beyond the sensor") {
    const Robot robot = dfdyn::tests::icub_right_arm();
    const RobotMotion motion = random_motion(robot, 400, dfdyn::tests::seed());
    const VectorXd nominal = nominal_parameters(robot, OutputKind::wrench);
    const MatrixXd wrench =
        unstacked(stacked_regressor(robot, OutputKind::wrench, motion) * (1.3 * nominal), 6);
    Recording recording;
    recording.output.names = output_names(OutputKind::wrench, 0);
    for (Index row = 0; row < motion.rows(); ++row) {
        recording.time_s.push_back(period_s * static_cast<double>(row));
        recording.time_ns.push_back(std::llround(1e9 * recording.time_s.back()));
        recording.gap_before.push_back(row == 0 ? 1 : 0);
        for (Index axis = 0; axis < 6; ++axis) {
            recording.output.values.push_back(wrench(row, axis) + static_cast<double>(axis));
        }
    }
    const auto set = [](Columns& columns, const char* name, const MatrixXd& values) {
        const MatrixXd by_rows = values.transpose();
        columns.names = joint_names(name, static_cast<std::size_t>(values.cols()));
        columns.values.assign(by_rows.data(), by_rows.data() + by_rows.size());
    };
    set(recording.position, "q", motion.position);
    set(recording.velocity, "qd", motion.velocity);
    set(recording.acceleration, "qdd", motion.acceleration);
    const ChainModel chain = chain_model(robot, OutputKind::wrench);
    const auto fits = fit_rigid_body(robot, chain, std::vector<double>(6, 1), sign_velocity, {&recording, 1});
    REQUIRE(fits.size() == 2);
    for (const RigidBodyFit& fit : fits) {
        CAPTURE(fit.identified);
        const Forecasts forecasts = rigid_body_forecasts(fit, chain, recording);
        for (std::size_t i = 0; i < forecasts.size(); ++i) {
            REQUIRE(forecasts[i] == Approx(recording.output.values[i]).epsilon(1e-4).margin(1e-4));
        }
    }
    CHECK(fits[0].output_gain[2] == Approx(1.3));
    CHECK(fits[0].friction[3 * 4 + 2] == Approx(4).epsilon(1e-6));
}

TEST_CASE("missing velocities are computed from the positions around a row but not across a gap") {
    DFDYN_SEEDED_ENGINE(engine);
    Recording training = recording_of(TwoJointMotion(engine), 700);
    measure(training, 0, engine);
    const RigidBodyFit fit = fit_planar(training)[1];
    Recording positions = training;
    positions.velocity = positions.acceleration = {};
    positions.gap_before[300] = 1;
    const Forecasts forecasts = forecasts_of(fit, positions);
    const auto half = static_cast<std::size_t>(rigid_body_window({&positions, 1}).half_width);
    for (std::size_t row = 0; row < 700; ++row) {
        CAPTURE(row);
        const bool known = (row >= half && row + half < 300) || (row >= 300 + half && row + half < 700);
        REQUIRE(std::isfinite(forecasts[2 * row]) == known);
        if (known) {
            REQUIRE(forecasts[2 * row + 1] == Approx(training.output.row(row)[1]).margin(0.1));
        }
    }
    CHECK(half == 5);
    positions.time_s.resize(1);
    positions.time_ns.resize(1);
    CHECK(std::isnan(forecasts_of(fit, positions)[0])); // one row has no motion
}

TEST_CASE("columns of rounding errors give no parameter that another motion would reveal") {
    DFDYN_SEEDED_ENGINE(engine);
    const TwoJointMotion motion(engine);
    std::normal_distribution<double> normal;
    Recording training = recording_of(motion, 700);
    measure(training, 0.1, engine);
    for (std::size_t row = 0; row < 700;
         ++row) { // the second joint is held, but the derivative of its position is not zero
        training.position.values[2 * row + 1] = 0.4;
        training.velocity.values[2 * row + 1] = 1e-14 * normal(engine);
        training.acceleration.values[2 * row + 1] = 1e-13 * normal(engine);
    }
    measure(training, 0.1, engine);
    Recording other = recording_of(motion, 300);
    measure(other, 0, engine);
    for (const RigidBodyFit& fit : fit_planar(training)) {
        CAPTURE(fit.identified);
        for (const double forecast : forecasts_of(fit, other)) {
            REQUIRE(std::abs(forecast) < 1000); // N·m; the arm's own torques are at most 60
        }
    }
}

TEST_CASE("a gain with which no plausible arm explains the outputs identifies no parameter") {
    DFDYN_SEEDED_ENGINE(engine);
    Recording training = recording_of(TwoJointMotion(engine), 700);
    measure(training, 0.5, engine);
    const std::vector<RigidBodyFit> fits = fit_planar(training, 1e-9);
    REQUIRE(fits.size() == 2);
    CHECK(fits[0].output_gain[0] == Approx(fit_planar(training)[0].output_gain[0])); // does not use the gain
    REQUIRE(fits[1].identified);
    CHECK(std::ranges::all_of(fits[1].inertia, [](double value) { return value == 0; }));
    CHECK(std::ranges::all_of(fits[1].friction, [](double value) { return value == 0; }));
}

TEST_CASE("a recording of exactly 20,000 rows is fitted with all of them") {
    DFDYN_SEEDED_ENGINE(engine);
    Recording training = recording_of(TwoJointMotion(engine), 20000);
    for (std::size_t i = 0; i < training.output.values.size(); ++i) {
        training.output.values[i] = i / 2 % 2 == 0 ? 1 : -1; // every second row alone has the offset 1
    }
    CHECK(std::abs(fit_planar(training)[0].friction[2]) < 0.1);
}

TEST_CASE("training data without a long enough segment give no rigid body") {
    DFDYN_SEEDED_ENGINE(engine);
    Recording training = recording_of(TwoJointMotion(engine), 10);
    training.velocity = training.acceleration = {};
    CHECK(fit_planar(training).empty());
}

} // namespace rigid_body_test
