// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/extension/extension.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/base/numerics/to_vector.hpp"
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/effects/effect_internals.hpp"
#include "tools/diagnosis/extension/corrected_robot.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/robot/dynamics/arm_dynamics.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/training/physics/robot_regressor.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

namespace {

using namespace dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// 8 s at 100 Hz, in which every joint swings with frequencies of its own.
MeasuredMotion swinging(const Robot& robot, std::mt19937_64& engine) {
    constexpr Index rows = 800;
    const auto joints = static_cast<Index>(robot.joints.size());
    std::uniform_real_distribution<double> uniform(0.5, 1.5);
    MeasuredMotion measured;
    measured.rate_hz = 100;
    measured.smoothing_hz = VectorXd::Constant(joints, 20);
    measured.time_s = VectorXd::LinSpaced(rows, 0, 7.99);
    measured.motion = {MatrixXd(rows, joints), MatrixXd(rows, joints), MatrixXd(rows, joints)};
    measured.outputs = MatrixXd::Zero(rows, 6);
    measured.velocity_noise = VectorXd::Constant(joints, 0.01);
    measured.stretches = {{0, rows}};
    for (Index joint = 0; joint < joints; ++joint) {
        const double rate = 2 * uniform(engine);
        const double phase = 6 * uniform(engine);
        const Eigen::ArrayXd angle = rate * measured.time_s.array() + phase;
        measured.motion.position.col(joint) = angle.sin();
        measured.motion.velocity.col(joint) = rate * angle.cos();
        measured.motion.acceleration.col(joint) = -rate * rate * angle.sin();
    }
    return measured;
}

/// Outputs of the extended model along a motion, computed by the firmware's columns.
MatrixXd outputs_of(const ModelExtension& extension, const RobotMotion& motion) {
    std::vector<EffectModel> effects;
    VectorXd parameters(extension.bodies.size() + static_cast<Index>(extension.columns.size()));
    parameters.head(extension.bodies.size()) = extension.bodies;
    for (const ExtensionColumn& column : extension.columns) {
        parameters[extension.bodies.size() + static_cast<Index>(effects.size())] = column.value;
        effects.push_back(column.effect);
    }
    const auto regressor = robot_regressor(chain_model(extension.robot, extension.kind), effects,
                                           to_vector(extension.output_gain));
    MatrixXd outputs(motion.rows(), extension.output_gain.size());
    MatrixXd values;
    for (Index row = 0; row < motion.rows(); ++row) {
        regressor->evaluate({motion.position.row(row).transpose(), motion.velocity.row(row).transpose(),
                             motion.acceleration.row(row).transpose()},
                            values);
        outputs.row(row) = (values * parameters).transpose();
    }
    return outputs;
}

/// A diagnosis that chose `candidate` in the given shape.
DiagnosisWork work_with(const std::shared_ptr<const DiagnosisSignals>& signals, const Candidate& candidate,
                        std::size_t shape, const VectorXd& coefficients) {
    DiagnosisWork work;
    work.signals = signals;
    work.torque_gains = VectorXd::Ones(signals->outputs());
    work.fitted_effects.candidates = {candidate};
    work.fitted_effects.chosen = {{0, shape}};
    work.fitted_effects.values.coefficients = coefficients;
    work.fitted_effects.values.covariance =
        1e-12 * MatrixXd::Identity(coefficients.size(), coefficients.size());
    return work;
}

/// Contribution of the candidate according to the diagnosis's own columns.
MatrixXd added_by(const DiagnosisSignals& signals, const Candidate& candidate, const EffectShape& shape,
                  const VectorXd& coefficients) {
    MatrixXd sum = MatrixXd::Zero(signals.rows(), signals.outputs());
    for (std::size_t i = 0; i < shape.columns.size(); ++i) {
        for (const EffectColumn::Part& part : candidate.columns[shape.columns[i]].parts) {
            sum.col(part.output) += coefficients[static_cast<Index>(i)] * part.series;
        }
    }
    return sum;
}

/// Returns false for effects that the extended model approximates: friction that builds up over a travel is
/// no function of the motion, and friction of two levels becomes one level and an offset, except at
/// reversals.
bool carried_exactly(const Candidate& candidate, std::size_t shape) {
    const std::vector<std::size_t>& columns = candidate.shapes[shape].columns;
    if (candidate.effect == "coulomb_friction") {
        return columns == std::vector<std::size_t>{0};
    }
    // Column 0 is a function of velocity, not of travel.
    return candidate.effect != "stribeck_friction" || columns.front() == 0;
}

/// Candidates that do not need a scan of the residual.
std::vector<Candidate> all_candidates(const DiagnosisSignals& signals) {
    std::vector<Candidate> candidates = static_candidates(signals);
    const std::vector<Candidate> more = fitted_candidates(signals, dfdyn::tests::rigid_model(signals));
    candidates.insert(candidates.end(), more.begin(), more.end());
    return candidates;
}

/// Checks, for a small amount of each candidate, that the extended model changes as the diagnosis's columns
/// do. Returns how many shapes of each effect were checked.
std::map<std::string, int> check_all(const std::shared_ptr<const DiagnosisSignals>& signals,
                                     const std::vector<Candidate>& candidates, std::mt19937_64& engine) {
    std::map<std::string, int> carried;
    const MatrixXd nominal =
        outputs_of(nominal_extension({signals, {}, VectorXd::Ones(signals->outputs()), {}, {}, {}, {}, {}}),
                   signals->measured.motion);
    std::uniform_real_distribution<double> uniform(0.5e-4, 1e-4);
    for (const Candidate& candidate : candidates) {
        for (std::size_t shape = 0; shape < candidate.shapes.size(); ++shape) {
            const EffectShape& one = candidate.shapes[shape];
            VectorXd coefficients(static_cast<Index>(one.columns.size()));
            for (double& coefficient : coefficients) {
                coefficient = uniform(engine);
            }
            if (candidate.effect == "payload" && coefficients.size() == 4) {
                coefficients.tail<3>() *= 0.01; // metres: a centimetre from the tip
            }
            const ModelExtension extension = extension_of(work_with(signals, candidate, shape, coefficients));
            const ExtendedFinding::How how = extension.carried.front().how;
            if ((how != ExtendedFinding::How::adapting && how != ExtendedFinding::How::fixed) ||
                !carried_exactly(candidate, shape)) {
                continue;
            }
            ++carried[candidate.effect];
            const MatrixXd expected = added_by(*signals, candidate, one, coefficients);
            const MatrixXd found = outputs_of(extension, signals->measured.motion) - nominal;
            CAPTURE(candidate.key(), shape, expected.norm(), found.norm());
            // Columns are derivatives and the model is exact: they differ by terms of second order.
            const double square =
                10 * coefficients.squaredNorm() * std::sqrt(static_cast<double>(expected.size()));
            CHECK((found - expected).norm() <= 3e-3 * expected.norm() + square);
        }
    }
    return carried;
}

/// A diagnosis of joint torques that has no findings yet.
DiagnosisWork work_of_swinging_ur5(std::mt19937_64& engine) {
    const Robot robot = dfdyn::tests::ur5();
    DiagnosisWork work;
    work.signals = std::make_shared<const DiagnosisSignals>(
        diagnosis_signals(robot, OutputKind::joint_torque, swinging(robot, engine)));
    work.torque_gains = VectorXd::Ones(6);
    return work;
}

} // namespace

TEST_CASE("the extended model of joint torques adds what the columns of the diagnosis add") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = dfdyn::tests::ur5();
    const auto signals = std::make_shared<const DiagnosisSignals>(
        diagnosis_signals(robot, OutputKind::joint_torque, swinging(robot, engine)));
    std::vector<Candidate> candidates = all_candidates(*signals);
    candidates.push_back(ripple_candidate(*signals, 2, {3, 40}));
    candidates.back().effect = "torque_ripple";
    const std::map<std::string, int> carried = check_all(signals, candidates, engine);
    for (const char* effect :
         {"viscous_friction", "coulomb_friction", "stribeck_friction", "torque_offset", "rotor_inertia",
          "joint_spring", "torque_ripple", "actuator_gain", "payload", "link_inertia_error",
          "link_rotational_inertia_error", "gravity_tilt", "encoder_offset"}) {
        CAPTURE(effect);
        CHECK(carried.contains(effect));
    }
}

TEST_CASE("the extended model of a wrench adds what the columns of the diagnosis add") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = dfdyn::tests::icub_right_arm();
    const auto signals = std::make_shared<const DiagnosisSignals>(
        diagnosis_signals(robot, OutputKind::wrench, swinging(robot, engine)));
    const std::vector<Candidate> candidates = all_candidates(*signals);
    const std::map<std::string, int> carried = check_all(signals, candidates, engine);
    for (const char* effect : {"ft_bias", "ft_gain", "ft_rotation", "payload", "link_inertia_error",
                               "link_rotational_inertia_error", "gravity_tilt", "encoder_offset"}) {
        CAPTURE(effect);
        CHECK(carried.contains(effect));
    }
    CHECK_FALSE(carried.contains("ft_crosstalk"));
}

TEST_CASE("the bias of an F/T sensor is not multiplied by the gain of its axis") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = dfdyn::tests::icub_right_arm();
    const auto signals = std::make_shared<const DiagnosisSignals>(
        diagnosis_signals(robot, OutputKind::wrench, swinging(robot, engine)));
    const std::vector<Candidate> candidates = all_candidates(*signals);
    const Candidate& gain = dfdyn::tests::find(candidates, "ft_gain", "ft_sensor"); // of fx
    const Candidate& bias = dfdyn::tests::find(candidates, "ft_bias", "ft_sensor");
    const VectorXd share = VectorXd::Constant(1, 0.2);
    const VectorXd force = VectorXd::Constant(1, 30); // N, on fx
    DiagnosisWork work = work_with(signals, gain, 0, VectorXd{{share[0], force[0]}});
    work.fitted_effects.candidates.push_back(bias);
    work.fitted_effects.chosen.push_back({1, 0});
    const MatrixXd expected = signals->nominal + added_by(*signals, gain, gain.shapes[0], share) +
                              added_by(*signals, bias, bias.shapes[0], force);
    const MatrixXd found = outputs_of(extension_of(work), signals->measured.motion);
    CHECK((found - expected).norm() < 1e-6 * expected.norm());
}

TEST_CASE("the extended model with an error of all masses and a payload is the fitted one") {
    DFDYN_SEEDED_ENGINE(engine);
    DiagnosisWork work = work_of_swinging_ur5(engine);
    const DiagnosisSignals& signals = *work.signals;
    const VectorXd nominal = nominal_parameters(signals.robot, signals.kind);
    FittedEffects& fitted = work.fitted_effects;
    fitted.uncertain_masses = 6;
    for (Index body = 0; body < 6; ++body) {
        fitted.nuisance.push_back(on_outputs(signals.of_body(body, nominal.segment<10>(10 * body))));
    }
    fitted.problem.nuisance.resize(6);
    fitted.candidates = {dfdyn::tests::find(static_candidates(signals), "payload", "tool")};
    fitted.chosen = {{0, 0}};
    fitted.values.coefficients = VectorXd::Constant(7, 0.1);
    fitted.values.coefficients[6] = 2; // kg
    fitted.values.covariance = 1e-12 * MatrixXd::Identity(7, 7);
    fitted.fit.coefficients = 0.5 * fitted.values.coefficients; // differs at outputs without an exact effect
    const MatrixXd expected = signals.nominal + fitted.reported_contribution(signals);
    const MatrixXd found = outputs_of(extension_of(work), signals.measured.motion);
    CHECK((found - expected).norm() < 1e-6 * expected.norm());
}

TEST_CASE("columns of the same effect at the same place are merged into one") {
    std::mt19937_64 engine(1);
    DiagnosisWork work = work_of_swinging_ur5(engine);
    const DiagnosisSignals& signals = *work.signals;
    for (const Candidate& candidate : static_candidates(signals)) {
        if (candidate.where == "joint2" &&
            (candidate.effect == "joint_spring" || candidate.effect == "torque_offset")) {
            work.fitted_effects.chosen.push_back({work.fitted_effects.candidates.size(), 0});
            work.fitted_effects.candidates.push_back(candidate);
        }
    }
    work.fitted_effects.values.coefficients =
        VectorXd::LinSpaced(3, 1, 3); // the spring's stiffness and offset, then the torque offset
    work.fitted_effects.values.covariance = MatrixXd::Identity(3, 3);
    const ModelExtension extension = extension_of(work);
    REQUIRE(extension.columns.size() == 2);
    CHECK(extension.columns[0].effect.name == "joint_spring");
    CHECK(extension.columns[0].value == 1);
    CHECK(extension.columns[1].effect.name == "torque_offset");
    CHECK(extension.columns[1].effect.row == 1);
    CHECK(extension.columns[1].value == 5);
    CHECK(extension.columns[1].deviation == Approx(std::sqrt(2.0)));
    const ModelExtension names = names_only(work, extension);
    CHECK(names.columns[1].value == 0);
    CHECK(names.columns[1].deviation == 5);
}

TEST_CASE("the corrected robot has the extended model's torques and lists what it cannot contain") {
    DFDYN_SEEDED_ENGINE(engine);
    DiagnosisWork work = work_of_swinging_ur5(engine);
    const DiagnosisSignals& signals = *work.signals;
    const std::map<std::string, std::pair<std::size_t, double>> hidden{
        {"viscous_friction@joint2 ", {0, 3}}, {"coulomb_friction@joint3 ", {0, 2}},
        {"rotor_inertia@joint1 ", {0, 0.5}},  {"payload@tool ", {0, 1.5}},
        {"torque_offset@joint4 ", {0, 0.7}},  {"link_inertia_error@link2 ", {0, -1}}};
    std::vector<double> coefficients;
    for (const Candidate& candidate : static_candidates(signals)) {
        if (const auto found = hidden.find(candidate.key()); found != hidden.end()) {
            work.fitted_effects.chosen.push_back(
                {work.fitted_effects.candidates.size(), found->second.first});
            work.fitted_effects.candidates.push_back(candidate);
            coefficients.push_back(found->second.second);
        }
    }
    REQUIRE(coefficients.size() == hidden.size());
    const auto count = static_cast<Index>(coefficients.size());
    work.fitted_effects.values.coefficients = Eigen::Map<const VectorXd>(coefficients.data(), count);
    work.fitted_effects.values.covariance = MatrixXd::Identity(count, count);
    const ModelExtension extension = extension_of(work);
    const RobotExport corrected = corrected_robot(extension, {"urdf"});
    CHECK(corrected.left_out == std::vector<std::string>{"torque_offset at joint4"});
    const ArmDynamics dynamics(corrected.robot, JointVector::Zero(6));
    ArmDynamics::Configuration configuration;
    const RobotMotion& motion = signals.measured.motion;
    const MatrixXd extended = outputs_of(extension, motion);
    for (Index row = 0; row < motion.rows(); row += 50) {
        const JointVector velocity = motion.velocity.row(row).transpose();
        dynamics.configure(motion.position.row(row).transpose(), configuration);
        JointVector torque =
            dynamics.inverse(configuration, velocity, motion.acceleration.row(row).transpose());
        torque[0] += corrected.joints[0].armature * motion.acceleration(row, 0);
        torque[1] += corrected.joints[1].damping * velocity[1];
        torque[3] += 0.7;                           // the offset, which was left out
        for (const Index joint : {0, 1, 3, 4, 5}) { // joint 3 has friction, whose sign is smooth in the model
            CHECK(torque[joint] == Approx(extended(row, joint)).margin(1e-6));
        }
        if (std::abs(velocity[2]) > 0.5) {
            const double friction = std::copysign(corrected.joints[2].friction, velocity[2]);
            CHECK(torque[2] + friction == Approx(extended(row, 2)).margin(1e-3));
        }
    }
}

TEST_CASE(
    "the corrected robot has the friction of plain least squares, and its gain and gravity are listed") {
    std::mt19937_64 engine(1);
    DiagnosisWork work = work_of_swinging_ur5(engine);
    const DiagnosisSignals& signals = *work.signals;
    work.measured = signals.nominal;
    work.measured.col(1) =
        0.8 * signals.nominal.col(1) + 3 * signals.measured.motion.velocity.col(1) + 2 * signals.direction(1);
    work.diagnosis.by_least_squares = {false, true, false, false, false, false};
    ModelExtension extension = extension_of(work);
    CHECK(extension.output_gain[1] == Approx(0.8).margin(1e-3));
    extension.robot.gravity.setZero();
    const RobotExport corrected = corrected_robot(extension, {"mjcf", "urdf"});
    CHECK(corrected.joints[1].damping == Approx(3).margin(0.01));
    CHECK(corrected.joints[1].friction == Approx(2).margin(0.01));
    for (const char* part :
         {"factor 0.8 of the rigid body at joint2", "gravity of 0 m/s² in a URDF: simulators use 9.81"}) {
        CAPTURE(part);
        CHECK(std::ranges::find(corrected.left_out, part) != corrected.left_out.end());
    }
    const RobotExport without_urdf = corrected_robot(extension, {"mjcf"});
    CHECK(std::ranges::none_of(without_urdf.left_out,
                               [](const std::string& part) { return part.starts_with("gravity"); }));
}
