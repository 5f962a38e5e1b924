// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel_effect.hpp"

#include "tools/simulation/arm_dynamics.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tests {

using namespace tools;

namespace {

constexpr double rotor_share = 0.15;       // of the link's own inertia about its axis
constexpr double contact_frequency = 1000; // rad/s, of the rotor on a closed gear
constexpr double gear_integration_rate_hz = 4000;

/// Inertia about the joint's axis of the link that it moves.
double own_inertia(const RobotJoint& joint) {
    const InertialParameters& body = joint.inertia;
    Eigen::Matrix3d inertia;
    inertia << body[4], body[5], body[6], body[5], body[7], body[8], body[6], body[8], body[9];
    return joint.axis.dot(inertia * joint.axis);
}

/// Takes the rotor out of the link, so that a rigid gear would make the arm that is described.
void take_rotor_out(RobotJoint& joint, double rotor) {
    const Eigen::Vector3d& a = joint.axis;
    joint.inertia.tail<6>() -= rotor * (Eigen::Matrix<double, 6, 1>() << a.x() * a.x(), a.x() * a.y(),
                                        a.x() * a.z(), a.y() * a.y(), a.y() * a.z(), a.z() * a.z())
                                           .finished();
}

void soften(Scenario& scenario, Eigen::Index joint, double rotor, double stiffness, double damping,
            double gap) {
    const JointVector zero = JointVector::Zero(scenario.actuators.rotor_inertia.size());
    GearModel& gear = scenario.actuators.gear;
    if (gear.stiffness.size() == 0) {
        gear = {zero, zero, zero};
    }
    scenario.actuators.rotor_inertia[joint] += rotor;
    gear.stiffness[joint] = stiffness;
    gear.damping[joint] = damping;
    gear.gap[joint] = gap;
}

/// N·m, per row of the reference.
Eigen::VectorXd gear_torque(const PanelSetup& setup, Eigen::Index joint) {
    PanelSetup torques = setup;
    torques.kind.outputs = OutputKind::joint_torque;
    torques.torque_constants.setOnes();
    return rigid_outputs(torques, setup.robot, setup.reference).col(joint);
}

/// The share of time during which the torque has the rarer sign: where it never turns, play is an offset.
double turning_share(const Eigen::VectorXd& torque) {
    const auto up = static_cast<double>((torque.array() > 0).count());
    const double share = up / static_cast<double>(torque.size());
    return std::min(share, 1 - share);
}

Eigen::VectorXd second_derivative(const Eigen::VectorXd& values, double period_s) {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(values.size());
    for (Eigen::Index row = 1; row + 1 < values.size(); ++row) {
        result[row] = (values[row - 1] - 2 * values[row] + values[row + 1]) / (period_s * period_s);
    }
    return result;
}

DrawnEffect backlash(const EffectDraw& of, Eigen::Index joint, double rotor) {
    const double stiffness = rotor * contact_frequency * contact_frequency;
    const double damping = 0.6 * rotor * contact_frequency;
    const Eigen::VectorXd torque = gear_torque(of.setup, joint);
    DrawnEffect effect;
    effect.hide = [joint, rotor, stiffness, damping](double size, Scenario& scenario) {
        soften(scenario, joint, rotor, stiffness, damping, size);
    };
    effect.parameters = [](double size) { return EffectParameters{{"gap", size}}; };
    if (turning_share(torque) > 0.1) {
        constexpr double small = 1e-3;
        MotionRows real = of.setup.reference;
        real.position.col(joint) -= small / 2 * torque.cwiseSign();
        effect.guess = small * of.strength / strength_along_reference(of.setup, real);
    }
    effect.largest = 0.15;
    return effect;
}

/// The size is the compliance, rad/(N·m).
DrawnEffect flexibility(const EffectDraw& of, Eigen::Index joint, double rotor) {
    const double loss = of.draw.uniform(0.02, 0.06); // damping ratio of the rotor on the gear
    const Eigen::VectorXd torque = gear_torque(of.setup, joint);
    DrawnEffect effect;
    effect.hide = [joint, rotor, loss](double size, Scenario& scenario) {
        soften(scenario, joint, rotor, 1 / size, 2 * loss * std::sqrt(rotor / size), 0);
    };
    effect.parameters = [](double size) { return EffectParameters{{"stiffness", 1 / size}}; };
    constexpr double small = 1e-6;
    MotionRows real = of.setup.reference;
    real.position.col(joint) -= small * torque;
    real.acceleration.col(joint) -= small * second_derivative(torque, 0.02);
    effect.guess = small * of.strength / strength_along_reference(of.setup, real);
    effect.largest = 0.02;
    return effect;
}

} // namespace

std::optional<DrawnEffect> draw_gear_effect(const std::string& name, const EffectDraw& of) {
    const Eigen::Index joint = of.joint();
    const auto link = static_cast<std::size_t>(joint);
    const double rotor = rotor_share * own_inertia(of.setup.robot.joints[link]);
    DrawnEffect effect = name == "backlash" ? backlash(of, joint, rotor) : flexibility(of, joint, rotor);
    effect.where = joint_place(joint);
    effect.integration_rate_hz = gear_integration_rate_hz;
    effect.rebuild = [link, rotor](Robot& robot) { take_rotor_out(robot.joints[link], rotor); };
    return effect;
}

} // namespace dfdyn::tests
