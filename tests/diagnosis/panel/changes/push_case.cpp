// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/changes/push_panel.hpp"
#include "tests/diagnosis/panel/recording/panel_run.hpp"
#include "tools/robot/dynamics/arm_dynamics.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tests {

using namespace tools;

namespace {

constexpr double push_case_s = 80;
constexpr double edge_s = 0.4; ///< of a wait, without a push at its ends

/// Postures near the middle of the setup's own task, with long waits between them.
PointToPointTask waits_between(const PanelSetup& setup, Draw& draw) {
    PointToPointTask task;
    task.move_s = draw.uniform(1.5, 2.5);
    task.dwell_s = draw.uniform(1.7, 3);
    const Eigen::MatrixXd& reached = setup.reference.position;
    for (int posture = 0; posture < 8; ++posture) {
        JointVector& position = task.postures.emplace_back(setup.joints());
        for (Eigen::Index joint = 0; joint < position.size(); ++joint) {
            const double centre = reached.col(joint).mean();
            const double half = std::min(0.8, (reached.col(joint).array() - centre).abs().maxCoeff());
            position[joint] = draw.uniform(centre - half, centre + half);
        }
    }
    return task;
}

/// Inertia of each joint in the first posture, without rotors.
Eigen::VectorXd inertia_of_joints(const PanelSetup& setup, const PointToPointTask& task) {
    const ArmDynamics dynamics(setup.robot, JointVector::Zero(setup.joints()));
    ArmDynamics::Configuration configuration;
    dynamics.configure(task.postures.front(), configuration);
    return dynamics.mass_matrix(configuration).diagonal();
}

/// Adds dry and viscous friction in proportion to the joint's own torques. Adds the gear's rotor too, so that
/// the bristles can be stiff.
void add_friction(PanelSetup& setup, const Eigen::VectorXd& inertia, Draw& draw) {
    constexpr double fastest = 2400;    // rad/s, of a rotor on its bristles
    constexpr double least_share = 0.1; // of the largest joint's torque
    Eigen::VectorXd torque(setup.joints());
    for (Eigen::Index joint = 0; joint < setup.joints(); ++joint) {
        torque[joint] = rms(setup.reference_output.col(joint)) * setup.torque_constants[joint];
    }
    for (Eigen::Index joint = 0; joint < setup.joints(); ++joint) {
        const double rotor = inertia[joint] * draw.uniform(0.3, 1);
        const double size = std::max(torque[joint], least_share * torque.maxCoeff());
        setup.scenario.actuators.rotor_inertia[joint] = rotor;
        LuGreParameters& friction = setup.scenario.actuators.friction[static_cast<std::size_t>(joint)];
        friction.coulomb = size * draw.uniform(0.15, 0.5);
        friction.breakaway = friction.coulomb * draw.uniform(1, 1.5);
        friction.stribeck_velocity = draw.uniform(0.03, 0.1);
        friction.viscous = friction.coulomb * draw.uniform(0.3, 1);
        add_bristles(friction, friction.coulomb, stiff_bend, rotor, fastest);
    }
}

/// Makes the controller as stiff as an industrial one.
void stiffen(PanelSetup& setup, Draw& draw) {
    Scenario& scenario = setup.scenario;
    scenario.integration_rate_hz = 8000;
    scenario.controller.rate_hz = 1000;
    scenario.controller.position_gain.setConstant(draw.log_uniform(4000, 10000));
    scenario.controller.velocity_gain.setConstant(160);
    scenario.actuators.bandwidth_hz = 0;
    scenario.encoders.bits_per_turn = 19;
    scenario.derivatives.noise_bound = 6.3 / std::exp2(scenario.encoders.bits_per_turn);
}

/// Draws a push at a random joint in every other wait.
std::vector<HiddenPush> draw_pushes(const PanelSetup& setup, const PointToPointTask& task, Draw& draw) {
    std::vector<HiddenPush> pushes;
    const double period = task.move_s + task.dwell_s;
    for (double wait = task.move_s; wait + period < push_case_s; wait += period) {
        if (!draw.chance(0.5)) {
            continue;
        }
        HiddenPush push;
        push.joint = static_cast<Eigen::Index>(draw.below(setup.robot.joints.size()));
        const double length = draw.uniform(0.5, std::min(1.2, task.dwell_s - 2 * edge_s));
        push.start_s = wait + draw.uniform(edge_s, task.dwell_s - edge_s - length);
        push.end_s = push.start_s + length;
        push.held = 2 * setup.scenario.actuators.friction[static_cast<std::size_t>(push.joint)].breakaway;
        push.peak = draw.sign() * push.held * draw.uniform(0.2, 3.5);
        pushes.push_back(push);
    }
    return pushes;
}

} // namespace

PushCase make_push_case(std::uint64_t seed) {
    Draw draw(seed, 91);
    PanelMix mix;
    mix.robot = draw.of(std::vector<std::string>{"ur5_torque", "ur5_current", "three_joint_torque"});
    mix.duration_s = push_case_s;
    PushCase result{make_panel_setup(seed, mix), {}, {}};
    PanelSetup& setup = result.setup;
    const PointToPointTask task = waits_between(setup, draw);
    setup.scenario.task = task;
    add_friction(setup, inertia_of_joints(setup, task), draw);
    stiffen(setup, draw);
    if (draw.chance(2.0 / 3)) {
        result.pushes = draw_pushes(setup, task, draw);
    }
    for (const HiddenPush& push : result.pushes) {
        setup.scenario.loads.contacts.push_back({push.start_s, push.end_s, push.joint, push.peak});
    }
    result.recording = recording_of(setup, run_panel(setup, setup.robot, setup.scenario));
    return result;
}

} // namespace dfdyn::tests
