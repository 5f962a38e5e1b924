// SPDX-License-Identifier: Apache-2.0
// Compares relinearized candidates, and candidates of events, with an independent computation of their
// effect.
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/effects/effect_internals.hpp"
#include "tools/robot/dynamics/arm_dynamics.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <random>

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Contribution of a candidate with the given coefficients of one of its shapes.
MatrixXd added(const DiagnosisSignals& signals, const Candidate& candidate, std::size_t shape,
               const VectorXd& coefficients) {
    MatrixXd sum = MatrixXd::Zero(signals.rows(), signals.outputs());
    for (Index i = 0; i < coefficients.size(); ++i) {
        sum += coefficients[i] *
               contribution(signals, candidate, candidate.shapes[shape].columns[static_cast<std::size_t>(i)]);
    }
    return sum;
}

double draw(std::mt19937_64& engine, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
}

} // namespace

TEST_CASE("a relinearized payload is exact at its centre of mass and at the tip") {
    DFDYN_SEEDED_ENGINE(engine);
    Robot robot = ur5();
    robot.tip_placement.rotate(
        Eigen::AngleAxisd(draw(engine, 0.3, 2), Eigen::Vector3d(1, 2, 2).normalized()));
    const DiagnosisSignals signals = signals_of(robot, OutputKind::joint_torque);
    const double mass = draw(engine, 0.5, 3);
    const Eigen::Vector3d centre(draw(engine, 0.05, 0.2), draw(engine, -0.2, 0.2), draw(engine, -0.2, 0.2));
    const VectorXd moments{{mass, mass * centre.x(), mass * centre.y(), mass * centre.z()}};
    const Candidate payload = find(static_candidates(signals), "payload", "tool");
    const Candidate exact = payload.relinearized_at(payload.shapes.back(), moments);
    const auto outputs_with = [&](const Eigen::Vector3d& at) -> MatrixXd {
        Robot loaded = robot;
        loaded.joints.back().inertia +=
            moved(body_parameters(mass, at, Eigen::Matrix3d::Zero()), robot.tip_placement);
        return rigid_outputs(loaded, signals.kind, signals.measured.motion) - signals.nominal;
    };
    check_same(added(signals, exact, 1, moments), outputs_with(centre), 1e-9);
    check_same(added(signals, exact, 0, moments.head(1)), outputs_with(Eigen::Vector3d::Zero()), 1e-9);
}

TEST_CASE("a relinearized tilt or encoder error is exact at a large angle") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const RobotMotion& motion = signals.measured.motion;
    const auto angle = [&engine] { return draw(engine, 0.05, 0.3) * (draw(engine, -1, 1) < 0 ? -1 : 1); };

    const VectorXd tilts{{angle(), angle()}};
    const Candidate tilt = find(static_candidates(signals), "gravity_tilt", "base");
    Robot tilted = signals.robot;
    tilted.gravity = Eigen::AngleAxisd(-tilts[0], Eigen::Vector3d::UnitX()) *
                     (Eigen::AngleAxisd(-tilts[1], Eigen::Vector3d::UnitY()) * tilted.gravity);
    check_same(added(signals, tilt.relinearized_at(tilt.shapes[0], tilts), 0, tilts),
               rigid_outputs(tilted, signals.kind, motion) - signals.nominal, 1e-9);

    const VectorXd offset = VectorXd::Constant(1, angle());
    const Candidate encoder = find(static_candidates(signals), "encoder_offset", "encoder3");
    RobotMotion truth = motion;
    truth.position.col(2).array() -= offset[0];
    check_same(added(signals, encoder.relinearized_at(encoder.shapes[0], offset), 0, offset),
               rigid_outputs(signals.robot, signals.kind, truth) - signals.nominal, 1e-9);

    // measured = true + a sin(true) + b cos(true)
    const VectorXd bent{{angle() / 2, angle() / 2}};
    const Candidate eccentric = find(static_candidates(signals), "encoder_eccentricity", "encoder3");
    truth = motion;
    for (Index row = 0; row < truth.rows(); ++row) {
        double& q = truth.position(row, 2);
        for (int repetition = 0; repetition < 60; ++repetition) {
            q = motion.position(row, 2) - bent[0] * std::sin(q) - bent[1] * std::cos(q);
        }
        const double slope = 1 + bent[0] * std::cos(q) - bent[1] * std::sin(q);
        const double bend = -bent[0] * std::sin(q) - bent[1] * std::cos(q);
        double& v = truth.velocity(row, 2);
        v = motion.velocity(row, 2) / slope;
        truth.acceleration(row, 2) = (motion.acceleration(row, 2) - bend * v * v) / slope;
    }
    check_same(added(signals, eccentric.relinearized_at(eccentric.shapes[0], bent), 0, bent),
               rigid_outputs(signals.robot, signals.kind, truth) - signals.nominal, 5e-3);
}

TEST_CASE("backlash takes the load off the drive while the link falls and returns it at the catch") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const Candidate backlash = backlash_candidate(signals, 4, {0.03, 0.075});
    const EffectShape& widest = backlash.shapes.back();
    const VectorXd gap = VectorXd::Constant(1, widest.value);
    CHECK(widest.allowed(gap));
    CHECK_FALSE(widest.allowed(2 * gap));
    const VectorXd course = added(signals, backlash, backlash.shapes.size() - 1, gap).col(4);
    const VectorXd load = signals.nominal.col(4);
    int falls = 0;
    int opposed = 0;
    for (Index row = 20; row + 20 < signals.rows(); ++row) {
        if (load[row - 3] * load[row - 2] < 0) { // the load has just changed its sign
            ++falls;
            opposed += course[row] * load[row] < 0 ? 1 : 0;
        }
    }
    CHECK(falls > 3);
    CHECK(opposed > 0.9 * falls);
    // The impulse of the catch equals the impulse that the fall took away.
    const auto inner = course.segment(20, signals.rows() - 40);
    CHECK(std::abs(inner.sum()) < 0.1 * inner.cwiseAbs().sum());
}

TEST_CASE("the gap of a backlash follows from the duration of the fall and not from the catch") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const Candidate backlash = backlash_candidate(signals, 4, {0.03, 0.075});
    const EffectShape& shape = backlash.shapes.back();
    const VectorXd soft = VectorXd::Constant(1, 0.4 * shape.value);
    CHECK(shape.allowed(soft));
    CHECK_FALSE(shape.allowed(soft / 2));
    CHECK(backlash.parameters(soft, shape).front().value == shape.value);
    const Candidate nearer = backlash.relinearized_at(shape, soft);
    CHECK(nearer.shapes.front().value == shape.value);
    for (const EffectShape& other : nearer.shapes) {
        CHECK(std::abs(other.value / shape.value - 1) < 0.15);
    }
}

TEST_CASE("a payload fit beyond the allowed distance returns the best allowed payload") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const EffectShape shape = find(static_candidates(signals), "payload", "tool").shapes[1];
    int bounded = 0;
    for (int trial = 0; trial < 50; ++trial) {
        const MatrixXd columns = MatrixXd::NullaryExpr(40, 4, [&] { return draw(engine, -1, 1); });
        const VectorXd target = columns * VectorXd::NullaryExpr(4, [&] { return draw(engine, -1, 1); });
        const MatrixXd squares = columns.transpose() * columns;
        const VectorXd moments = columns.transpose() * target;
        if (shape.allowed(squares.llt().solve(moments))) {
            continue;
        }
        const VectorXd best = shape.nearest(squares, moments);
        const auto left = [&](const VectorXd& coefficients) {
            return (target - columns * coefficients).norm();
        };
        if (!shape.allowed(best)) {
            continue; // the best fit has no mass
        }
        ++bounded;
        for (int other = 0; other < 300; ++other) {
            const VectorXd near = best + VectorXd::NullaryExpr(4, [&] { return draw(engine, -0.1, 0.1); });
            if (shape.allowed(near)) {
                REQUIRE(left(near) > left(best) - 2e-3);
            }
        }
    }
    CHECK(bounded > 5);
}

TEST_CASE("a push at the tip is a force along the base's axes with a lever about the sensor") {
    const Robot robot = icub_right_arm();
    const DiagnosisSignals signals = signals_of(robot, OutputKind::wrench);
    const std::vector<ContactSite> sites = contact_sites(signals);
    REQUIRE(sites.size() == 1);
    const ContactPulse pulse{4, 6, 0.5};
    const Candidate contact = contact_candidate(signals, sites[0], pulse, pulses_about(pulse, 0.15));
    CHECK(contact.where == "ft_sensor");
    const Eigen::Vector3d force(3, -2, 5);
    const MatrixXd found = added(signals, contact, 0, force);
    const auto parameters = contact.parameters(force, contact.shapes[0]);
    CHECK(parameters[2].value == Approx(force.norm()));
    CHECK(parameters[4].value == Approx(-2 / force.norm()));
    const ArmDynamics dynamics(robot, JointVector::Zero(static_cast<Index>(robot.joints.size())));
    ArmDynamics::Configuration configuration;
    for (const Index row : {100, 500, 550, 900}) {
        dynamics.configure(signals.measured.motion.position.row(row), configuration);
        const Eigen::Isometry3d tip = configuration.place.back() * robot.tip_placement;
        const Eigen::Isometry3d sensor =
            configuration.place[robot.sensor->link - 1] * robot.sensor->placement;
        const Eigen::Vector3d lever = tip.translation() - sensor.translation();
        VectorXd passed(6);
        passed << sensor.linear().transpose() * force, sensor.linear().transpose() * lever.cross(force);
        const double now = row == 500 || row == 550 ? 1 : 0;
        const double sign = robot.sensor->parent_to_child ? -1 : 1;
        CHECK((found.row(row).transpose() - sign * now * passed).norm() < 1e-9);
    }
}

TEST_CASE("refined pulses surround the pulse that was found and keep it as the first") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const std::vector<ContactSite> sites = contact_sites(signals);
    const ContactPulse pulse{4, 6, 0.6};
    const Candidate first = contact_candidate(signals, sites[1], pulse, pulses_about(pulse, 0.15));
    const Candidate nearer = first.relinearized_at(first.shapes[5], VectorXd::Ones(1));
    CHECK(nearer.key() == first.key());
    CHECK((contribution(signals, nearer, 0) - contribution(signals, first, 5)).norm() < 1e-12);
    const auto start = [](const Candidate& candidate, std::size_t shape) {
        return candidate.parameters(VectorXd::Ones(1), candidate.shapes[shape])[0].value;
    };
    CHECK(start(first, 3) == Approx(4 - 0.15 * 2));
    const auto values = nearer.parameters(VectorXd::Ones(1), nearer.shapes[0]);
    const double length = values[1].value - values[0].value;
    CHECK(start(nearer, 3) == Approx(start(nearer, 0) - 0.075 * length));
}

TEST_CASE("a payload picked up later adds nothing before that time and its full weight afterwards") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const std::vector<EffectColumn> columns = payload_columns(signals);
    const Candidate taken = taken_payload(signals, columns, {7.005, 9});
    const Candidate permanent = find(static_candidates(signals), "payload", "tool");
    for (std::size_t column = 0; column < 4; ++column) {
        const MatrixXd late = contribution(signals, taken, column);
        CHECK(late.topRows(701).isZero(0));
        CHECK((late - contribution(signals, permanent, column)).bottomRows(1299).isZero(0));
    }
    const VectorXd mass = VectorXd::Constant(1, 0.4);
    const auto parameters = taken.parameters(mass, taken.shapes[0]);
    CHECK(parameters.front().value == 0.4);
    CHECK(parameters.back().name == "attached");
    CHECK(parameters.back().value == 7.005);
}
