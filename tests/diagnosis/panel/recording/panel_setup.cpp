// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/recording/panel_setup.hpp"

#include "tests/diagnosis/panel/effects/panel_effect.hpp"
#include "tests/diagnosis/panel/recording/panel_band.hpp"
#include "tools/base/text/error.hpp"
#include "tools/robot/dynamics/arm_dynamics.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tests {

using namespace tools;

namespace {

constexpr double reference_rate_hz = 50;
constexpr double integration_rate_hz = 2000;
/// Smallest noise of an output, as a share of the noise of the largest output of its unit.
constexpr double floor_share = 0.05;

JointVector zeros(const Robot& robot) {
    return JointVector::Zero(static_cast<Eigen::Index>(robot.joints.size()));
}

Scenario base_scenario(const PanelRobot& kind, const Robot& robot, double duration_s, Draw& draw) {
    Scenario scenario;
    scenario.seed = draw.seed();
    scenario.integration_rate_hz = integration_rate_hz;
    scenario.recording.rate_hz = draw.of(kind.conditions.rates_hz);
    scenario.recording.samples = static_cast<std::size_t>(duration_s * scenario.recording.rate_hz);
    scenario.task = random_task(kind, robot, duration_s, draw);
    scenario.controller.rate_hz = 500;
    scenario.controller.position_gain = JointVector::Constant(zeros(robot).size(), 225);
    scenario.controller.velocity_gain = JointVector::Constant(zeros(robot).size(), 30);
    scenario.actuators.rotor_inertia = zeros(robot);
    scenario.actuators.friction.resize(robot.joints.size());
    scenario.actuators.bandwidth_hz = 60;
    scenario.torque_sensor.noise = zeros(robot);
    scenario.encoders.eccentricity = zeros(robot);
    scenario.encoders.eccentricity_phase = zeros(robot);
    scenario.encoders.bits_per_turn = draw.whole(kind.conditions.least_bits, kind.conditions.most_bits);
    scenario.derivatives.rate_hz = 10; // the derivatives of the simulation are not used
    scenario.derivatives.velocity_window = 40;
    scenario.derivatives.acceleration_window = 40;
    scenario.derivatives.noise_bound = 6.3 / std::exp2(scenario.encoders.bits_per_turn);
    if (kind.outputs == OutputKind::wrench) {
        scenario.force_torque.emplace();
        scenario.force_torque->range << 500, 500, 500, 50, 50, 50;
        scenario.force_torque->bits = kind.conditions.sensor_bits;
    }
    return scenario;
}

MotionRows reference_motion(const PanelSetup& setup) {
    const auto task = make_task(setup.scenario.task, setup.robot, 1 / reference_rate_hz, setup.scenario.seed);
    const auto rows = static_cast<Eigen::Index>(setup.duration_s * reference_rate_hz);
    const Eigen::MatrixXd empty(rows, setup.joints());
    MotionRows motion{empty, empty, empty};
    for (Eigen::Index row = 0; row < rows; ++row) {
        const Reference reference = task->next();
        motion.position.row(row) = reference.position.transpose();
        motion.velocity.row(row) = reference.velocity.transpose();
        motion.acceleration.row(row) = reference.acceleration.transpose();
    }
    return motion;
}

OutputNoiseModel unit_noise(const std::string& name, Eigen::Index joints, Draw& draw) {
    OutputNoiseModel model;
    model.torque = JointVector::Ones(joints);
    model.wrench = Wrench::Ones();
    if (name == "ar1_0.9") {
        model.coefficient = 0.9;
    } else if (name == "ar1_0.98") {
        model.coefficient = 0.98;
    } else if (name == "resampled") {
        model.series = draw.of(real_residuals());
    } else if (name != "white") {
        throw InputError("noise: expected white, ar1_0.9, ar1_0.98 or resampled, found " + name);
    }
    return model;
}

/// Size of each output, at least a share of the largest of its unit.
Eigen::VectorXd sizes(const PanelSetup& setup) {
    const Eigen::MatrixXd& rows = setup.reference_output;
    Eigen::VectorXd size =
        (rows.colwise().squaredNorm() / static_cast<double>(rows.rows())).cwiseSqrt().transpose();
    if (setup.wrench()) {
        size.head(3) = size.head(3).cwiseMax(floor_share * size.head(3).maxCoeff());
        size.tail(3) = size.tail(3).cwiseMax(floor_share * size.tail(3).maxCoeff());
        return size;
    }
    return size.cwiseMax(floor_share * size.maxCoeff());
}

void add_noise(PanelSetup& setup, Draw& draw) {
    OutputNoise noise(unit_noise(setup.noise, setup.joints(), draw), draw.seed());
    setup.noise_rms = sizes(setup);
    for (double& rms : setup.noise_rms) {
        rms *= draw.uniform(setup.kind.conditions.least_noise, setup.kind.conditions.largest_noise);
    }
    const auto rows = static_cast<Eigen::Index>(setup.scenario.recording.samples);
    setup.noise_rows.resize(rows, setup.noise_rms.size());
    for (Eigen::Index row = 0; row < rows; ++row) {
        const Eigen::VectorXd unit =
            setup.wrench() ? Eigen::VectorXd(noise.wrench()) : Eigen::VectorXd(noise.torque());
        setup.noise_rows.row(row) = unit.cwiseProduct(setup.noise_rms).transpose();
    }
    setup.noise_in_band = band_rms(setup.noise_rows, setup.scenario.recording.rate_hz);
}

/// Draws an independent mass error for each link; the centres of mass stay.
void mistake_masses(PanelSetup& setup, const PanelMix& mix, Draw draw) {
    const bool off = draw.chance(0.5);
    setup.masses_off = mix.masses_off.value_or(off);
    setup.nominal = setup.robot;
    for (std::size_t link = 0; link < setup.robot.joints.size(); ++link) {
        const double error = setup.masses_off ? draw.uniform(-largest_mass_error, largest_mass_error) : 0;
        setup.mass_errors.push_back(error);
        setup.nominal.joints[link].inertia *= 1 + error;
        if (setup.nominal.sensor && setup.nominal.sensor->link == link + 1) {
            setup.nominal.sensor->inertia_beyond *= 1 + error;
        }
    }
}

void choose_arm(PanelSetup& setup, std::uint64_t seed, const std::string& name) {
    if (name == unknown_arm) {
        UnknownArm arm = draw_unknown_arm(seed);
        setup.kind = std::move(arm.kind);
        setup.robot = std::move(arm.robot);
        return;
    }
    setup.kind = panel_robot(name);
    setup.robot = read_panel_robot(setup.kind);
}

} // namespace

std::vector<std::string> panel_noise_names() { return {"white", "ar1_0.9", "ar1_0.98", "resampled"}; }

std::string PanelSetup::output_name(Eigen::Index output) const {
    return output_names(kind.outputs, robot.joints.size())[static_cast<std::size_t>(output)];
}

PanelSetup make_panel_setup(std::uint64_t seed, const PanelMix& mix) {
    Draw draw(seed, 1);
    PanelSetup setup;
    // Drawn even if given, so that all other draws are unchanged.
    const std::string robot = draw.of(panel_robot_names());
    const std::string noise = draw.of(panel_noise_names());
    setup.noise = mix.noise.value_or(noise);
    choose_arm(setup, seed, mix.robot.value_or(robot));
    const PanelConditions& conditions = setup.kind.conditions;
    mistake_masses(setup, mix, Draw(seed, 2));
    const double duration_s = draw.uniform(conditions.shortest_s, conditions.longest_s);
    setup.duration_s = mix.duration_s.value_or(duration_s);
    setup.scenario = base_scenario(setup.kind, setup.robot, setup.duration_s, draw);
    setup.torque_constants = Eigen::VectorXd::Ones(setup.joints());
    if (setup.kind.outputs == OutputKind::motor_current) {
        for (double& constant : setup.torque_constants) {
            constant = draw.uniform(conditions.least_constant, conditions.largest_constant);
        }
        setup.constants_known = draw.chance(mix.known_constants_share);
    }
    setup.reference = reference_motion(setup);
    setup.reference_output = rigid_outputs(setup, setup.robot, setup.reference);
    add_noise(setup, draw);
    Draw gears(seed, 5);
    const bool possible = !setup.wrench() && (!mix.effect || fits_ordinary_gears(*mix.effect));
    if (possible && gears.chance(conditions.ordinary_share)) {
        add_ordinary_gears(setup, gears);
    }
    return setup;
}

Eigen::MatrixXd rigid_outputs(const PanelSetup& setup, const Robot& robot, const MotionRows& motion) {
    const Eigen::Index joints = motion.position.cols();
    const ArmDynamics dynamics(robot, JointVector::Zero(joints));
    ArmDynamics::Configuration configuration;
    Eigen::MatrixXd result(motion.position.rows(), setup.wrench() ? 6 : joints);
    for (Eigen::Index row = 0; row < result.rows(); ++row) {
        const JointVector velocity = motion.velocity.row(row).transpose();
        const JointVector acceleration = motion.acceleration.row(row).transpose();
        dynamics.configure(motion.position.row(row).transpose(), configuration);
        if (setup.wrench()) {
            result.row(row) = dynamics.wrench(configuration, velocity, acceleration).transpose();
        } else {
            result.row(row) = dynamics.inverse(configuration, velocity, acceleration).transpose();
        }
    }
    if (setup.torque_constants.size() > 0 && !setup.wrench()) {
        result = result * setup.torque_constants.cwiseInverse().asDiagonal();
    }
    return result;
}

} // namespace dfdyn::tests
