// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tools/base/text/error.hpp"
#include "tools/simulation/arm/lugre_friction.hpp"
#include "tools/simulation/scenario/robot_errors.hpp"
#include "tools/simulation/sensors/output_noise.hpp"
#include "tools/simulation/sensors/torque_sensor.hpp"

#include "tests/tools/simulation/small_arms.hpp"

#include <cmath>

namespace sensor_errors_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

struct Statistics {
    double deviation = 0, neighbours = 0;
};

Statistics statistics(const OutputNoiseModel& model) {
    UnitNoise noise(model, 7, 0);
    constexpr int rows = 200000;
    double squares = 0;
    double products = 0;
    double past = 0;
    for (int row = 0; row < rows; ++row) {
        const double value = noise.next();
        squares += value * value;
        products += value * past;
        past = value;
    }
    return {std::sqrt(squares / rows), products / squares};
}

/// Friction in steady state at `velocity`.
double settled(LuGreFriction& friction, double velocity) {
    for (int i = 0; i < 1000; ++i) {
        friction.advance(velocity, 1e-3);
    }
    return friction.torque(velocity);
}

TEST_CASE("friction has a level per direction and a share of the load and a drift") {
    LuGreParameters parameters;
    parameters.stiffness = 1000;
    parameters.coulomb = parameters.breakaway = 1;
    parameters.viscous = 0.5;
    parameters.negative_excess = 0.4;
    parameters.load_coefficient = 0.1;
    parameters.drift_per_s = 0.02;
    LuGreFriction friction(parameters);
    CHECK(settled(friction, 2) == Approx(1 + 0.5 * 2));
    CHECK(settled(friction, -2) == Approx(-1.4 - 0.5 * 2));
    friction.set_conditions(10, -30);
    CHECK(settled(friction, 2) == Approx(1.2 * 1 + 0.1 * 30 + 1.2 * 0.5 * 2));
    friction.set_conditions(1e6, 0);
    CHECK(settled(friction, -2) > -1e5);
    parameters.drift_per_s = -1;
    LuGreFriction gone(parameters);
    gone.set_conditions(5, 0); // zero friction instead of friction that drives
    CHECK(std::abs(settled(gone, 2)) < 1e-6);
}

TEST_CASE("a torque reading is the delayed torque divided by the gain plus the offset") {
    TorqueSensorModel model;
    model.noise = JointVector::Zero(2);
    model.gain = JointVector::Constant(2, 1.25);
    model.offset = JointVector::Constant(2, 0.5);
    model.delay_s = JointVector::Zero(2);
    (*model.delay_s)[1] = 2.5e-3;
    TorqueSensor sensor(model, 1e-3, 1);
    JointVector torque(2);
    for (int step = 0; step <= 10; ++step) {
        torque << step, 100 + step;
        sensor.observe(torque);
    }
    const JointVector reading = sensor.read(torque);
    CHECK(reading[0] == Approx(10 / 1.25 + 0.5));
    CHECK(reading[1] == Approx((110 - 2.5) / 1.25 + 0.5));
}

TEST_CASE("coloured noise has standard deviation 1 and its coefficient and white noise has no correlation") {
    OutputNoiseModel model;
    CHECK(statistics(model).deviation == Approx(1).epsilon(0.02));
    CHECK(std::abs(statistics(model).neighbours) < 0.01);
    model.coefficient = 0.9;
    CHECK(statistics(model).deviation == Approx(1).epsilon(0.05));
    CHECK(statistics(model).neighbours == Approx(0.9).epsilon(0.01));
}

TEST_CASE("resampled noise has standard deviation 1 and the correlation of its series at any scale") {
    OutputNoiseModel coloured;
    coloured.coefficient = 0.8;
    UnitNoise source(coloured, 3, 0);
    OutputNoiseModel model;
    for (int row = 0; row < 20000; ++row) {
        model.series.push_back(40 + 5 * source.next());
    }
    CHECK(statistics(model).deviation == Approx(1).epsilon(0.05));
    CHECK(statistics(model).neighbours == Approx(0.8).epsilon(0.03));
    model.series.resize(100);
    CHECK_THROWS_AS(UnitNoise(model, 1, 0), InputError);
    model.series.assign(1000, 3);
    CHECK_THROWS_AS(UnitNoise(model, 1, 0), InputError);
}

TEST_CASE("each output has independent noise of its own size") {
    OutputNoiseModel model;
    model.torque = JointVector(2);
    model.torque << 0.1, 3;
    CHECK(OutputNoise(model, 5).wrench().isZero(0));
    model.wrench << 0.5, 1, 20, 0.02, 0.3, 4;
    OutputNoise noise(model, 5);
    using Outputs = Eigen::Matrix<double, 8, 1>;
    Eigen::Matrix<double, 8, 8> products = Eigen::Matrix<double, 8, 8>::Zero();
    constexpr int rows = 20000;
    for (int row = 0; row < rows; ++row) {
        Outputs values;
        values << noise.torque(), noise.wrench();
        products += values * values.transpose();
    }
    products /= rows;
    Outputs expected;
    expected << model.torque, model.wrench;
    for (Eigen::Index i = 0; i < 8; ++i) {
        CAPTURE(i);
        CHECK(std::sqrt(products(i, i)) == Approx(expected[i]).epsilon(0.03));
        for (Eigen::Index other = 0; other < i; ++other) {
            CAPTURE(other);
            CHECK(std::abs(products(i, other) / std::sqrt(products(i, i) * products(other, other))) < 0.03);
        }
    }
}

TEST_CASE("link errors change mass and centre of mass and must leave a positive mass") {
    RobotErrors errors;
    errors.links = {{0, 0.5, Eigen::Vector3d(0.1, 0, 0)}};
    const Robot real = real_robot(pendulum(1, 0.5), errors);
    const InertialParameters& body = real.joints[0].inertia;
    CHECK(body[0] == Approx(1.5));
    CHECK(body[1] == Approx(1.5 * 0.1));
    CHECK(body[3] == Approx(-1.5 * 0.5));
    errors.links[0].delta_mass = -1;
    CHECK_THROWS_WITH(real_robot(pendulum(1, 0.5), errors), Catch::Matchers::ContainsSubstring("link 1"));
}

TEST_CASE("link errors change the moments of inertia about the centre of mass within physical limits") {
    RobotErrors errors;
    errors.links = {{0, 0, Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0.2, 0.2)}};
    const Robot described = pendulum(1, 0.5);
    const InertialParameters change =
        real_robot(described, errors).joints[0].inertia - described.joints[0].inertia;
    CHECK((change - body_parameters(0, Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0.2, 0.2).asDiagonal()))
              .norm() < 1e-12);
    errors.links[0].delta_inertia = {0, 0.2, 0}; // violates the triangle inequality of moments of inertia
    CHECK_THROWS_WITH(real_robot(described, errors), Catch::Matchers::ContainsSubstring("link 1"));
}

TEST_CASE("a base that is not the root is tilted about the axes of the root") {
    Robot robot = pendulum(1, 0.5);
    // The x axis of the base is the y axis of the root, its y axis the root's -x axis.
    robot.base_in_root = Eigen::AngleAxisd(std::acos(-1) / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    RobotErrors errors;
    errors.tilt_x = 0.3; // about the -y axis of the base
    const Eigen::Vector3d expected = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()) * robot.gravity;
    CHECK((real_robot(robot, errors).gravity - expected).norm() < 1e-12);
}

} // namespace sensor_errors_test
