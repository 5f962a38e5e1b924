// SPDX-License-Identifier: Apache-2.0
// Compares the columns of effects with an independent computation of each effect on the rigid body.
#include "tools/diagnosis/candidates/dependence_candidates.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/regressor.hpp"
#include "tools/simulation/arm/lugre_friction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

} // namespace

TEST_CASE("the nominal outputs are the firmware's regressor times the nominal parameters") {
    for (const OutputKind kind : {OutputKind::joint_torque, OutputKind::wrench}) {
        const DiagnosisSignals signals = signals_of(icub_right_arm(), kind);
        const MatrixXd expected =
            unstacked(signals.regressor * nominal_parameters(signals.robot, kind), signals.outputs());
        CHECK((signals.nominal - expected).cwiseAbs().maxCoeff() < 1e-10);
    }
}

TEST_CASE("a tilted base rotates gravity about the x and y axes of the root link") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const std::vector<Candidate> candidates = static_candidates(signals);
    const Candidate& tilt = find(candidates, "gravity_tilt", "base");
    constexpr double angle = 1e-4;
    for (int axis = 0; axis < 2; ++axis) {
        Robot tilted = signals.robot;
        // A base turned by +angle sees gravity turned by -angle.
        tilted.gravity = axis == 0 ? Eigen::Vector3d(0, -9.81 * std::sin(angle), -9.81 * std::cos(angle))
                                   : Eigen::Vector3d(9.81 * std::sin(angle), 0, -9.81 * std::cos(angle));
        const MatrixXd change =
            (rigid_outputs(tilted, signals.kind, signals.measured.motion) - signals.nominal) / angle;
        check_same(contribution(signals, tilt, static_cast<std::size_t>(axis)), change, 1e-3);
    }
}

TEST_CASE("a payload is a point mass at the tip and a link's mass error one at its centre of mass") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const std::vector<Candidate> candidates = static_candidates(signals);
    const auto with_mass = [&](std::size_t joint, const Eigen::Vector3d& centre) {
        Robot heavier = signals.robot;
        heavier.joints[joint].inertia += body_parameters(1, centre, Eigen::Matrix3d::Zero());
        return MatrixXd(rigid_outputs(heavier, signals.kind, signals.measured.motion) - signals.nominal);
    };
    check_same(contribution(signals, find(candidates, "payload", "tool"), 0),
               with_mass(5, signals.robot.tip_placement.translation()), 1e-9);
    const InertialParameters& third = signals.robot.joints[2].inertia;
    check_same(contribution(signals, find(candidates, "link_inertia_error", "link3"), 0),
               with_mass(2, third.segment<3>(1) / third[0]), 1e-9);
}

TEST_CASE("a link's moments of inertia act as those of another link, and as a rotor at the first joint") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const std::vector<Candidate> candidates = static_candidates(signals);
    const Candidate& third = find(candidates, "link_rotational_inertia_error", "link3");
    const std::array<std::pair<Index, Index>, 6> elements{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
    for (std::size_t element = 0; element < elements.size(); ++element) {
        CAPTURE(element);
        const auto [row, column] = elements[element];
        Robot other = signals.robot;
        CentralBody body = central_body(other.joints[2].inertia);
        body.inertia(row, column) += 1;
        body.inertia(column, row) += row == column ? 0 : 1;
        other.joints[2].inertia = body_parameters(body.mass, body.centre, body.inertia);
        const MatrixXd change = rigid_outputs(other, signals.kind, signals.measured.motion) - signals.nominal;
        check_same(contribution(signals, third, element + 1), change, 1e-9); // column 0 is the scale
    }
    const auto has = [&](const std::string& where) {
        return std::ranges::any_of(candidates, [&](const Candidate& one) {
            return one.effect == "link_rotational_inertia_error" && one.where == where;
        });
    };
    CHECK(has("link2"));
    CHECK_FALSE(has("link1"));
}

TEST_CASE("the columns of encoder errors are the change of the rigid-body torques at the true positions") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const std::vector<Candidate> candidates = static_candidates(signals);
    constexpr double amount = 1e-4;
    // `swing` is the encoder's reading; the true position is the reading minus the encoder's error.
    const auto outputs_at = [&](const VectorXd& error, const VectorXd& error_rate,
                                const VectorXd& error_acceleration) {
        RobotMotion truth = signals.measured.motion;
        truth.position.col(2) -= amount * error;
        truth.velocity.col(2) -= amount * error_rate;
        truth.acceleration.col(2) -= amount * error_acceleration;
        return MatrixXd((rigid_outputs(signals.robot, signals.kind, truth) - signals.nominal) / amount);
    };
    const Index rows = signals.rows();
    check_same(contribution(signals, find(candidates, "encoder_offset", "encoder3"), 0),
               outputs_at(VectorXd::Ones(rows), VectorXd::Zero(rows), VectorXd::Zero(rows)), 1e-3);
    const Eigen::ArrayXd q = signals.measured.motion.position.col(2);
    const Eigen::ArrayXd v = signals.measured.motion.velocity.col(2);
    const Eigen::ArrayXd a = signals.measured.motion.acceleration.col(2);
    check_same(contribution(signals, find(candidates, "encoder_eccentricity", "encoder3"), 0),
               outputs_at(q.sin(), q.cos() * v, q.cos() * a - q.sin() * v.square()), 5e-3);
}

TEST_CASE("Coulomb friction opposes the motion and presliding friction builds up with the travel") {
    DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    // Joint 1 moves forward, rests, and moves back.
    auto position = signals.measured.motion.position.col(0);
    auto velocity = signals.measured.motion.velocity.col(0);
    for (Index row = 0; row < 2000; ++row) {
        velocity[row] = row < 800 ? 0.5 : row < 1200 ? 0.0 : -0.5;
        position[row] = row == 0 ? 0.0 : position[row - 1] + 0.01 * velocity[row];
    }
    const std::vector<Candidate> candidates = static_candidates(signals);
    const Candidate& coulomb = find(candidates, "coulomb_friction", "joint1");
    const MatrixXd by_travel = contribution(signals, coulomb, 1);
    CHECK(by_travel(500, 0) == Approx(1).margin(1e-3));
    CHECK(by_travel(1000, 0) == Approx(1).margin(1e-3));
    CHECK(by_travel(1800, 0) == Approx(-1).margin(1e-3));
    const MatrixXd by_velocity = contribution(signals, coulomb, 0);
    CHECK(by_velocity(500, 0) == Approx(1).margin(1e-3));
    CHECK(std::abs(by_velocity(1000, 0)) < 1e-12);
    const Candidate& presliding = find(candidates, "presliding_hysteresis", "joint1");
    const EffectShape& shape = presliding.shapes.back();
    const MatrixXd rising = contribution(signals, presliding, shape.columns[0]);
    const double travel = position[100] - position[0];
    CHECK(rising(100, 0) == Approx(1 - std::exp(-travel / shape.value)).margin(1e-6));
    CHECK(by_travel.rightCols(5).isZero(0));
}

TEST_CASE("parameters have the signs and units of the catalogue") {
    const DiagnosisSignals signals = signals_of(icub_right_arm(), OutputKind::wrench);
    const std::vector<Candidate> candidates = fitted_candidates(signals, rigid_model(signals));
    const Candidate& delay = find(candidates, "delay", "ft_sensor");
    // A sensor that lags by 1 ms.
    const MatrixXd lagging = contribution(signals, delay, 0) * 1e-3;
    MatrixXd later(signals.rows(), 6);
    for (Index axis = 0; axis < 6; ++axis) {
        later.col(axis) = -1e-3 * signals.rate(signals.nominal.col(axis));
    }
    check_same(lagging, later, 1e-9);
    const auto gain =
        std::ranges::find_if(candidates, [](const Candidate& one) { return one.effect == "ft_gain"; });
    REQUIRE(gain != candidates.end());
    CHECK(gain->parameters(VectorXd::Constant(1, 0.2), gain->shapes[0])[0].value == Approx(1.2));
    const DiagnosisSignals torques = signals_of(ur5(), OutputKind::joint_torque);
    const std::vector<Candidate> actuators = fitted_candidates(torques, rigid_model(torques));
    // The gain is true over assumed torque: the log contains the true torque divided by it.
    CHECK(find(actuators, "actuator_gain", "actuator2")
              .parameters(VectorXd::Constant(1, 0.25), EffectShape{})[0]
              .value == Approx(0.8));
    CHECK(std::ranges::none_of(fitted_candidates(torques, rigid_model(torques, false)),
                               [](const Candidate& one) { return one.effect == "actuator_gain"; }));
}

TEST_CASE("an unnamed dependence is a function of its inputs and not larger than the rigid body's residual") {
    const Robot robot = ur5();
    const DiagnosisSignals signals = signals_of(robot, OutputKind::joint_torque);
    const VectorXd velocity = signals.measured.motion.velocity.col(2);
    MatrixXd unexplained = MatrixXd::Zero(signals.rows(), 6);
    unexplained.col(0) = 0.7 * velocity.cwiseAbs2();
    const std::vector<Candidate> all = dependence_candidates(signals, unexplained);
    const auto found = std::ranges::find_if(all, [](const Candidate& one) {
        return one.where == "output1" && one.inputs == std::vector<std::string>{"qd3"};
    });
    REQUIRE(found != all.end());
    CHECK_FALSE(found->named());
    check_same(contribution(signals, *found, 0).col(0), velocity.cwiseAbs2(), 1e-12);
    CHECK(found->shapes[0].allowed(VectorXd::Constant(1, 0.7)));
    CHECK_FALSE(found->shapes[0].allowed(VectorXd::Constant(1, 1.4)));
    // The bound holds for any basis, also where the basis functions cancel each other.
    const auto of_position = std::ranges::find_if(all, [](const Candidate& one) {
        return one.where == "output1" && one.inputs == std::vector<std::string>{"q1"};
    });
    REQUIRE(of_position != all.end());
    const EffectShape& widest = of_position->shapes.back();
    VectorXd coefficients = VectorXd::Ones(static_cast<Index>(widest.columns.size()));
    MatrixXd sum = MatrixXd::Zero(signals.rows(), 6);
    for (const std::size_t column : widest.columns) {
        sum += contribution(signals, *of_position, column);
    }
    coefficients *= unexplained.col(0).norm() / sum.col(0).norm();
    CHECK(widest.allowed(1.4 * coefficients));
    CHECK_FALSE(widest.allowed(1.6 * coefficients));
}

TEST_CASE("the column of a delay is the delayed series minus the present one divided by the delay") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const Eigen::ArrayXd time = signals.measured.time_s.array();
    const VectorXd series = (7 * time).sin();
    for (const double delay : {0.0034, 0.02, 0.083}) {
        const VectorXd expected = ((7 * (time - delay)).sin() - (7 * time).sin()) / delay;
        check_same(signals.per_delay(series, delay), expected, 1e-4);
    }
    check_same(signals.per_delay(series, 0), -7 * (7 * time).cos(), 1e-4);
}

TEST_CASE("load-dependent friction is LuGre friction whose Coulomb level is a share of the load") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    constexpr Index joint = 2;
    constexpr double mu = 0.15;
    const VectorXd load = signals.nominal.col(joint).cwiseAbs();
    const double usual = std::sqrt(load.squaredNorm() / static_cast<double>(load.size()));
    const std::vector<Candidate> candidates = static_candidates(signals);
    const Candidate& candidate = find(candidates, "load_dependent_friction", "joint3");
    double last_bend = 0;
    for (const EffectShape& shape : candidate.shapes) {
        CHECK(shape.value > last_bend);
        last_bend = shape.value;
        LuGreParameters parameters;
        parameters.load_coefficient = mu;
        parameters.stiffness = mu * usual / shape.value;
        LuGreFriction friction(parameters);
        MatrixXd expected = MatrixXd::Zero(signals.rows(), 1);
        const VectorXd velocity = signals.measured.motion.velocity.col(joint);
        for (Index row = 1; row < signals.rows(); ++row) {
            constexpr int substeps = 20;
            for (int substep = 0; substep < substeps; ++substep) {
                const double part = (substep + 0.5) / substeps;
                friction.set_conditions(0, load[row - 1] + part * (load[row] - load[row - 1]));
                friction.advance(velocity[row - 1] + part * (velocity[row] - velocity[row - 1]),
                                 0.01 / substeps);
            }
            expected(row, 0) = parameters.stiffness * friction.deflection();
        }
        const VectorXd found = mu * contribution(signals, candidate, shape.columns.front()).col(joint);
        // If the direction changes within a row and the bend is short, that row is between the two levels.
        CHECK((found - expected.col(0)).norm() < 0.05 * expected.col(0).norm());
    }
}

TEST_CASE("a Stribeck candidate requires static friction clearly above Coulomb friction") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const Candidate stribeck = find(static_candidates(signals), "stribeck_friction", "joint2");
    REQUIRE_FALSE(stribeck.shapes.empty());
    for (const EffectShape& shape : stribeck.shapes) {
        CHECK(shape.allowed(VectorXd{{2, 0.3}}));
        CHECK_FALSE(shape.allowed(VectorXd{{2, 0.1}}));
        CHECK_FALSE(shape.allowed(VectorXd{{2, -0.3}}));
        CHECK_FALSE(shape.allowed(VectorXd{{-2, 0.3}}));
    }
}

TEST_CASE("centres of mass on a planar arm have no component along its axes, and no shape is offered twice") {
    using Columns = std::vector<std::size_t>;
    const std::vector<Candidate> plane =
        static_candidates(signals_of(planar_arm(9.81), OutputKind::joint_torque));
    const Candidate& link = find(plane, "link_inertia_error", "link2");
    REQUIRE(link.shapes.size() == 3);
    CHECK(link.shapes[0].columns == Columns{0});
    CHECK(link.shapes[1].columns == Columns{1, 2});
    CHECK(link.shapes[2].columns == Columns{0, 1, 2});
    CHECK(link.shapes[2].bounded_count == 2);
    const std::vector<EffectParameter> moved = link.parameters(VectorXd{{0.1, -0.2}}, link.shapes[1]);
    REQUIRE(moved.size() == 3); // of a link of 1 kg
    CHECK(moved[1].name == "delta_com_x");
    CHECK(moved[1].value == Approx(0.1));
    CHECK(moved[2].name == "delta_com_y");
    CHECK(moved[2].value == Approx(-0.2));
    CHECK(link.shapes[1].allowed(VectorXd{{0.1, -0.2}}));
    CHECK_FALSE(link.shapes[1].allowed(VectorXd{{0.2, -0.3}})); // farther than 0.3 m

    const Candidate& at_one_joint = find(plane, "link_inertia_error", "link1");
    CHECK(at_one_joint.shapes.size() == 1); // the others could be an encoder's offset and a rotor, too

    const Candidate& payload = find(plane, "payload", "tool");
    REQUIRE(payload.shapes.size() == 2);
    CHECK(payload.shapes[1].columns == Columns{0, 1, 2});
    CHECK(payload.parameters(VectorXd{{2, 0.2, 0.4}}, payload.shapes[1]).size() == 3);

    // without gravity every change of the first link is one of its inertia about the axis
    const std::vector<Candidate> level =
        static_candidates(signals_of(planar_arm(0), OutputKind::joint_torque));
    const Candidate& first = find(level, "link_inertia_error", "link1");
    REQUIRE(first.shapes.size() == 1);
    CHECK(first.prior_trials == 3); // the prior of a mass error is that of other arms
}

TEST_CASE("the shapes of a centre of mass in space have all components") {
    using Columns = std::vector<std::size_t>;
    const std::vector<Candidate> space = static_candidates(signals_of(ur5(), OutputKind::joint_torque));
    const Candidate& link = find(space, "link_inertia_error", "link3");
    REQUIRE(link.shapes.size() == 3);
    CHECK(link.shapes[1].columns == Columns{1, 2, 3});
    CHECK(link.shapes[2].columns == Columns{0, 1, 2, 3});
    CHECK(link.shapes[2].bounded_count == 3);
    CHECK(link.shapes[2].undetermined == 0);
    CHECK(link.prior_trials == 1);
    const Candidate& payload = find(space, "payload", "tool");
    REQUIRE(payload.shapes.size() == 2);
    CHECK(payload.shapes[1].columns == Columns{0, 1, 2, 3});
    CHECK(payload.shapes[1].bounded_count == 3);
    CHECK(payload.prior_trials == 1);
    CHECK(find(space, "link_inertia_error", "link1").shapes.size() == 1); // it turns about a vertical axis
}
