// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/effects/panel_effect.hpp"

#include "tools/robot/dynamics/arm_dynamics.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tests {

using namespace tools;

namespace {

constexpr double rotor_share = 0.6;        // of the smallest inertia of the joint
constexpr double contact_frequency = 1000; // rad/s, of the rotor on closed teeth
constexpr double slowest_frequency = 25;   // rad/s, of the arm on a soft gear
constexpr double gear_integration_rate_hz = 4000;

/// Returns the mean inertias of all joints during the reference motion, each with the others held.
Eigen::VectorXd mean_inertia(const PanelSetup& setup) {
    const ArmDynamics dynamics(setup.robot, JointVector::Zero(setup.joints()));
    ArmDynamics::Configuration configuration;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(setup.joints());
    double count = 0;
    for (Eigen::Index row = 0; row < setup.reference.position.rows(); row += 50) {
        dynamics.configure(setup.reference.position.row(row).transpose(), configuration);
        sum += dynamics.mass_matrix(configuration).diagonal();
        ++count;
    }
    return sum / count;
}

/// Subtracts the rotor from the link, so that the arm with a rigid gear is the nominal one.
void take_rotor_out(RobotJoint& joint, double rotor) {
    joint.inertia -= body_parameters(0, Eigen::Vector3d::Zero(), rotor * joint.axis * joint.axis.transpose());
}

/// Tunes the feedback of a motor with a soft gear for its rotor instead of the arm.
void retune(Scenario& scenario, const Eigen::VectorXd& inertia, Eigen::Index joint, double rotor) {
    ControllerModel& controller = scenario.controller;
    controller.kind = ControllerKind::feed_forward;
    controller.velocity_gain = 14 * inertia;
    controller.position_gain = 7 * controller.velocity_gain;
    // A light rotor needs a fast drive: otherwise the link's weight turns it over.
    controller.rate_hz = scenario.encoders.rate_hz = 2000;
    controller.velocity_gain[joint] = 150 * rotor;
    controller.position_gain[joint] = 20 * controller.velocity_gain[joint];
    scenario.actuators.bandwidth_hz = 500;
    scenario.encoders.bits_per_turn = std::max(scenario.encoders.bits_per_turn, 17);
    scenario.derivatives.velocity_window = 6;
}

struct Gear {
    Eigen::VectorXd inertia; ///< mean of each joint during the reference motion, kg·m²
    Eigen::Index joint;
    double rotor;
};

void soften(Scenario& scenario, const Gear& soft, double stiffness, double damping, double gap) {
    const JointVector zero = JointVector::Zero(scenario.actuators.rotor_inertia.size());
    GearModel& gear = scenario.actuators.gear;
    if (gear.stiffness.size() == 0) {
        gear = {zero, zero, zero};
    }
    scenario.actuators.rotor_inertia[soft.joint] += soft.rotor;
    gear.stiffness[soft.joint] = stiffness;
    gear.damping[soft.joint] = damping;
    gear.gap[soft.joint] = gap;
    retune(scenario, soft.inertia, soft.joint, soft.rotor);
}

Eigen::VectorXd second_derivative(const Eigen::VectorXd& values, double period_s) {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(values.size());
    for (Eigen::Index row = 1; row + 1 < values.size(); ++row) {
        result[row] = (values[row - 1] - 2 * values[row] + values[row + 1]) / (period_s * period_s);
    }
    return result;
}

DrawnEffect play_of_gear(const EffectDraw& of, const Gear& gear) {
    const Eigen::Index joint = gear.joint;
    const double stiffness = gear.rotor * contact_frequency * contact_frequency;
    const double damping = 0.6 * gear.rotor * contact_frequency;
    DrawnEffect effect;
    effect.hide = [gear, stiffness, damping](double size, Scenario& scenario) {
        soften(scenario, gear, stiffness, damping, size);
    };
    effect.parameters = [](double size) { return EffectParameters{{"gap", size}}; };
    // The impact of the link at the end of the gap adds to the effect of the angle.
    effect.guess = guess_of_gap(of, joint, joint_torque(of.setup, joint));
    effect.largest = 0.15;
    return effect;
}

/// Compliance of a gear; the size is in rad/(N·m).
DrawnEffect flexibility(const EffectDraw& of, const Gear& gear) {
    const Eigen::Index joint = gear.joint;
    const double loss = of.draw.uniform(0.02, 0.06); // damping ratio of the rotor on the gear
    const Eigen::VectorXd torque = joint_torque(of.setup, joint);
    DrawnEffect effect;
    effect.hide = [gear, loss](double size, Scenario& scenario) {
        soften(scenario, gear, 1 / size, 2 * loss * std::sqrt(gear.rotor / size), 0);
    };
    effect.parameters = [](double size) { return EffectParameters{{"stiffness", 1 / size}}; };
    constexpr double small = 1e-6;
    MotionRows real = of.setup.reference;
    real.position.col(joint) -= small * torque;
    real.acceleration.col(joint) -= small * second_derivative(torque, 0.02);
    effect.guess = small * of.strength / strength_along_reference(of.setup, real);
    effect.largest = 1 / (gear.inertia[joint] * slowest_frequency * slowest_frequency);
    return effect;
}

DrawnEffect with_gear(const EffectDraw& of, DrawnEffect (*draw)(const EffectDraw&, const Gear&)) {
    const Eigen::Index joint = of.joint();
    const auto link = static_cast<std::size_t>(joint);
    const double rotor = rotor_share * least_inertia(of.setup, joint);
    const Gear gear{mean_inertia(of.setup), joint, rotor};
    DrawnEffect effect = draw(of, gear);
    effect.where = joint_place(joint);
    effect.soft = true;
    effect.integration_rate_hz = gear_integration_rate_hz;
    effect.rebuild = [link, rotor](Robot& robot) { take_rotor_out(robot.joints[link], rotor); };
    return effect;
}

} // namespace

double guess_of_gap(const EffectDraw& of, Eigen::Index joint, const Eigen::VectorXd& load) {
    constexpr double small = 1e-3;
    const double up = (load.array() > 0).cast<double>().mean(); // share of the time
    if (std::min(up, 1 - up) <= 0.1) {
        return 0;
    }
    MotionRows real = of.setup.reference;
    real.position.col(joint) -= small / 2 * load.cwiseSign();
    return std::min(0.03, small * of.strength / strength_along_reference(of.setup, real));
}

namespace hidden_effects {

DrawnEffect backlash(const EffectDraw& of) { return with_gear(of, play_of_gear); }
DrawnEffect joint_flexibility(const EffectDraw& of) { return with_gear(of, flexibility); }

} // namespace hidden_effects

} // namespace dfdyn::tests
