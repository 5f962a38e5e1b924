// SPDX-License-Identifier: Apache-2.0
// Properties of the regressor of any chain. tests/truth compares the torques and wrenches themselves.
#include "dfdyn/physics/rigid_body.hpp"

#include "tests/firmware_lib/support/counted.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"

#include <Eigen/SVD>
#include <unsupported/Eigen/AutoDiff>

#include <functional>

namespace rigid_body_test {

using namespace dfdyn;
using namespace dfdyn::tests;

template <class Scalar>
using Rows = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
template <class Scalar>
using Column = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

template <class Arm, class Real, class Scalar>
Rows<Scalar> regressor(const typename Arm::template Constants<Real>& chain, const typename Arm::Sizes& sizes,
                       const Column<Scalar>& xi) {
    const int columns = inertial_parameters * sizes.body_count;
    Rows<Scalar> psi(static_cast<int>(sizes.output_count), columns);
    rigid_body_regressor<Arm, Real>(chain, sizes, xi.data(), psi.data(), columns);
    return psi;
}

using Torques = Chain<dynamic>;
using Wrench = Chain<dynamic, WrenchAtSensor<dynamic>>;

Torques::Sizes torque_sizes(int n) { return {{n}, {n}, {n}}; }

tools::Robot revolute_robot(std::mt19937_64& engine, int n) {
    tools::Robot robot = random_robot(engine, n);
    for (tools::RobotJoint& joint : robot.joints) {
        joint.prismatic = false;
    }
    return robot;
}

/// Returns the number of identifiable combinations of parameters.
Eigen::Index identifiable(std::mt19937_64& engine, int n,
                          const std::function<Rows<double>(const Eigen::VectorXd&)>& rows_of) {
    Rows<double> stacked;
    for (int trial = 0; trial < 200; ++trial) {
        const Rows<double> rows = rows_of(random_motion(engine, n));
        stacked.conservativeResize(stacked.rows() + rows.rows(), rows.cols());
        stacked.bottomRows(rows.rows()) = rows;
    }
    const Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXd>(stacked).singularValues();
    return (values.array() > 1e-10 * values[0]).count();
}

Eigen::Index identifiable_by_torques(std::mt19937_64& engine, const tools::Robot& robot) {
    const int n = static_cast<int>(robot.joints.size());
    const auto chain = chain_of<Torques>(robot);
    return identifiable(engine, n, [&](const Eigen::VectorXd& xi) {
        return regressor<Torques, double>(chain, torque_sizes(n), xi);
    });
}

/// Joint positions and their derivatives at a given time.
struct Trajectory {
    Eigen::VectorXd size, rate, phase;

    [[nodiscard]] Eigen::VectorXd at(double time) const {
        Eigen::VectorXd xi(3 * size.size());
        for (Eigen::Index i = 0; i < size.size(); ++i) {
            const double angle = rate[i] * time + phase[i];
            xi[3 * i] = size[i] * std::sin(angle);
            xi[3 * i + 1] = size[i] * rate[i] * std::cos(angle);
            xi[3 * i + 2] = -size[i] * rate[i] * rate[i] * std::sin(angle);
        }
        return xi;
    }
};

/// Kinetic and potential energy in the base's frame, J.
double energy(const tools::Robot& robot, const Eigen::VectorXd& xi) {
    Eigen::Isometry3d link = Eigen::Isometry3d::Identity();
    Eigen::Vector3d angular = Eigen::Vector3d::Zero();
    Eigen::Vector3d linear = Eigen::Vector3d::Zero(); // of the link's origin
    double total = 0;
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        const tools::RobotJoint& joint = robot.joints[i];
        const double position = xi[static_cast<Eigen::Index>(3 * i)];
        const double velocity = xi[static_cast<Eigen::Index>(3 * i + 1)];
        const Eigen::Isometry3d next =
            link * joint.placement *
            (joint.prismatic ? Eigen::Isometry3d(Eigen::Translation3d(position * joint.axis))
                             : Eigen::Isometry3d(Eigen::AngleAxisd(position, joint.axis)));
        linear += angular.cross(next.translation() - link.translation());
        link = next;
        const Eigen::Vector3d axis = link.linear() * joint.axis * velocity;
        (joint.prismatic ? linear : angular) += axis;
        const Body body = body_of(joint.inertia);
        const Eigen::Vector3d centre_velocity = linear + angular.cross(link.linear() * body.centre);
        const Eigen::Vector3d turning = link.linear().transpose() * angular;
        total += body.mass * (centre_velocity.squaredNorm() / 2 - robot.gravity.dot(link * body.centre)) +
                 turning.dot(body.central_inertia * turning) / 2;
    }
    return total;
}

double power(const tools::Robot& robot, const Eigen::VectorXd& xi) {
    const int n = static_cast<int>(robot.joints.size());
    const Rows<double> psi = regressor<Torques, double>(chain_of<Torques>(robot), torque_sizes(n), xi);
    double total = 0;
    for (int k = 0; k < n; ++k) {
        for (int i = 0; i < n; ++i) {
            total += xi[3 * k + 1] * psi.row(k)
                                         .segment<inertial_parameters>(inertial_parameters * i)
                                         .dot(robot.joints[static_cast<std::size_t>(i)].inertia);
        }
    }
    return total;
}

TEST_CASE("the joints' power equals the rate of change of the energy") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 50; ++trial) {
        const int n = 1 + trial % 7;
        const tools::Robot robot = random_robot(engine, n);
        const auto random = [&](double from, double to) {
            return Eigen::VectorXd::NullaryExpr(n, [&, from, to] { return uniform(engine, from, to); })
                .eval();
        };
        const Trajectory trajectory{random(0.3, 1.5), random(0.5, 3), random(0, 6)};
        const double time = uniform(engine, 0, 10);
        const auto slope = [&](double step) {
            return (energy(robot, trajectory.at(time + step)) - energy(robot, trajectory.at(time - step))) /
                   (2 * step);
        };
        const double expected = (4 * slope(1e-3) - slope(2e-3)) / 3;
        CAPTURE(trial);
        CHECK(power(robot, trajectory.at(time)) == Approx(expected).epsilon(1e-7).margin(1e-6));
    }
}

// M. Gautier, W. Khalil, "Direct calculation of minimum set of inertial parameters of serial robots", IEEE
// Trans. Robotics and Automation 6(3), 1990: a revolute joint adds 7 combinations and a prismatic joint 4.
// The total is reduced by 4, or by 6 if the first joint rotates about the direction of gravity.
TEST_CASE("the number of identifiable parameter combinations of the torques agrees with theory") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int n = 2; n <= 6; ++n) {
        CAPTURE(n);
        tools::Robot robot = revolute_robot(engine, n);
        CHECK(identifiable_by_torques(engine, robot) == 7 * n - 4);
        robot.gravity = 9.81 * (robot.joints[0].placement.linear() * robot.joints[0].axis);
        CHECK(identifiable_by_torques(engine, robot) == 7 * n - 6);
    }
    tools::Robot robot = revolute_robot(engine, 5);
    robot.joints[3].prismatic = true;
    CHECK(identifiable_by_torques(engine, robot) == 7 * 4 + 4 - 4);
}

TEST_CASE("a wrench identifies ten parameters of the sensor's link and seven of each later link") {
    DFDYN_SEEDED_ENGINE(engine);
    const tools::Robot robot = revolute_robot(engine, 5);
    auto chain = chain_of<Wrench>(robot);
    chain.output = {3, placement_of(random_placement(engine)), 1};
    const Eigen::Index count = identifiable(engine, 5, [&](const Eigen::VectorXd& xi) {
        return regressor<Wrench, double>(chain, {{5}, {}, {3}}, xi);
    });
    CHECK(count == 10 + 7 + 7);
}

TEST_CASE("the regressor in float has the accuracy of float") {
    DFDYN_SEEDED_ENGINE(engine);
    using Arm = Chain<6>;
    for (int trial = 0; trial < 200; ++trial) {
        const auto chain = chain_of<Arm>(random_robot(engine, 6));
        Arm::Constants<float> single{};
        for (int i = 0; i < 6; ++i) {
            const ChainJoint<double>& joint = chain.joint[i];
            std::copy_n(joint.placement.rotation, 9, single.joint[i].placement.rotation);
            std::copy_n(joint.placement.translation, 3, single.joint[i].placement.translation);
            std::copy_n(joint.axis, 3, single.joint[i].axis);
            single.joint[i].prismatic = joint.prismatic;
        }
        std::copy_n(chain.gravity, 3, single.gravity);
        const Column<double> xi = random_motion(engine, 6);
        const Rows<double> expected = regressor<Arm, double>(chain, {}, xi);
        const Rows<float> psi = regressor<Arm, float>(single, {}, Column<float>(xi.cast<float>()));
        CHECK((psi.cast<double>() - expected).norm() < 2e-6 * expected.norm());
    }
}

TEST_CASE("a scalar with derivatives gives the derivatives of the regressor") {
    DFDYN_SEEDED_ENGINE(engine);
    using Dual = Eigen::AutoDiffScalar<Eigen::VectorXd>;
    constexpr int n = 3;
    const auto chain = chain_of<Torques>(random_robot(engine, n));
    const Column<double> xi = random_motion(engine, n);
    Column<Dual> dual(3 * n);
    for (int i = 0; i < 3 * n; ++i) {
        dual[i] = Dual(xi[i], 3 * n, i);
    }
    const Rows<Dual> psi = regressor<Torques, double>(chain, torque_sizes(n), dual);
    for (int i = 0; i < 3 * n; ++i) {
        const Column<double> step = 1e-5 * Column<double>::Unit(3 * n, i);
        const Rows<double> slope =
            (regressor<Torques, double>(chain, torque_sizes(n), Column<double>(xi + step)) -
             regressor<Torques, double>(chain, torque_sizes(n), Column<double>(xi - step))) /
            2e-5;
        for (Eigen::Index k = 0; k < psi.size(); ++k) {
            const Eigen::VectorXd& derivatives = psi.data()[k].derivatives();
            // A constant zero has no derivatives.
            const double derivative = derivatives.size() == 0 ? 0 : derivatives[i];
            REQUIRE(derivative == Approx(slope.data()[k]).epsilon(1e-6).margin(1e-6));
        }
    }
}

TEST_CASE("rows are a stride apart and the gaps are not written") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto chain = chain_of<Torques>(random_robot(engine, 2));
    const Column<double> xi = random_motion(engine, 2);
    const Rows<double> expected = regressor<Torques, double>(chain, torque_sizes(2), xi);
    Rows<double> psi = Rows<double>::Constant(2, 23, 77);
    rigid_body_regressor<Torques>(chain, torque_sizes(2), xi.data(), psi.data(), 23);
    CHECK((psi.leftCols(20) - expected).norm() == 0);
    CHECK((psi.rightCols(3).array() == 77).all());
}

TEMPLATE_TEST_CASE("the rigid body costs what its declaration says", "", Chain<1>, Chain<4>, Chain<7>,
                   (Chain<4, WrenchAtSensor<4>>), (Chain<7, WrenchAtSensor<3>>)) {
    using Arm = TestType;
    using Number = Counted<double>;
    typename Arm::template Constants<Number> chain{};
    if constexpr (!std::is_same_v<typename Arm::Output, JointTorques>) {
        chain.output.link = Arm::joints == Arm::bodies ? 0 : Arm::joints - Arm::bodies + 1;
    }
    const std::vector<Number> xi(3 * Arm::joints);
    std::vector<Number> psi(Arm::outputs * Arm::parameters);
    counted_operations = 0;
    rigid_body_regressor<Arm, Number>(chain, {}, xi.data(), psi.data(), Arm::parameters);
    CHECK(counted_operations == rigid_body_cost<Arm, Number>({}));
    for (ChainJoint<Number>& joint : chain.joint) {
        joint.prismatic = true; // without sine and cosine
    }
    counted_operations = 0;
    rigid_body_regressor<Arm, Number>(chain, {}, xi.data(), psi.data(), Arm::parameters);
    CHECK(counted_operations == rigid_body_cost<Arm, Number>({}) - cos_sin_cost<Number>(1) * Arm::joints);
}

} // namespace rigid_body_test
