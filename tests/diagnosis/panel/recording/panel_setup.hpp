// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel/recording/panel_case.hpp"
#include "tests/diagnosis/panel/recording/panel_random.hpp"
#include "tools/simulation/scenario/scenario.hpp"

#include <Eigen/Core>

namespace dfdyn::tests {

/// Relative, of a link's mass, in recordings with wrong masses.
inline constexpr double largest_mass_error = 0.1;

/// Ranges of the random properties of a recording.
struct PanelConditions {
    std::vector<double> rates_hz = {100, 125, 200, 250};
    int least_bits = 14, most_bits = 20;              ///< of an encoder, per turn
    int sensor_bits = 20;                             ///< of an F/T sensor, for its whole range
    double least_noise = 0.01, largest_noise = 0.05;  ///< rms, per rms of the output
    double shortest_s = 40, longest_s = 60;           ///< durations
    double least_constant = 7, largest_constant = 14; ///< torque constants, N·m/A
    int most_redraws = 200;                           ///< of effects that cannot have the wanted strength
    double ordinary_share = 0;    ///< of the arms of which all joints have friction and rotors
    bool everyday_motion = false; ///< also few postures, and one joint after another
};

/// An arm of the panel with one kind of outputs.
struct PanelRobot {
    std::string name, urdf, tip;
    tools::OutputKind outputs = tools::OutputKind::joint_torque;
    double speed = 0;         ///< rad/s, maximum of its joints
    double largest_range = 0; ///< rad, maximum excursion of a joint on either side of its centre
    PanelConditions conditions = {};
};

const std::vector<PanelRobot>& panel_robots();
const PanelRobot& panel_robot(const std::string& name);
tools::Robot read_panel_robot(const PanelRobot& robot);

/// An arm that is different for every seed.
struct UnknownArm {
    PanelRobot kind;
    tools::Robot robot;
};
UnknownArm draw_unknown_arm(std::uint64_t seed);

/// Length of the stretched arm from its base to its tip, m.
double reach_of(const tools::Robot& robot);

/// Joint motion or outputs with one row per sample.
struct MotionRows {
    Eigen::MatrixXd position, velocity, acceleration;
};

/// An arm and its motion without hidden effects, and the noise of its outputs.
struct PanelSetup {
    PanelRobot kind;
    tools::Robot robot;   ///< true arm
    tools::Robot nominal; ///< with the errors of the robot description
    bool masses_off = false;
    std::vector<double> mass_errors; ///< per link: nominal over true, minus 1
    tools::Scenario scenario;        ///< without noise
    bool constants_known = true;
    Eigen::VectorXd torque_constants; ///< N·m/A; all ones unless the outputs are currents
    MotionRows reference;             ///< motion of the task, 50 rows per second
    Eigen::MatrixXd reference_output;
    std::string noise;
    Eigen::MatrixXd noise_rows; ///< in the units of the recording
    Eigen::VectorXd noise_rms, noise_in_band;
    double duration_s = 0;
    std::vector<HiddenEffect> ordinary; ///< friction and rotors of all joints, or none
    Eigen::MatrixXd ordinary_outputs;   ///< their contribution to the outputs, or empty

    Eigen::Index outputs() const { return noise_rms.size(); }
    Eigen::Index joints() const { return static_cast<Eigen::Index>(robot.joints.size()); }
    bool wrench() const { return kind.outputs == tools::OutputKind::wrench; }
    std::string output_name(Eigen::Index output) const;
};

/// Gives all joints friction and rotors.
void add_ordinary_gears(PanelSetup& setup, Draw draw);

PanelSetup make_panel_setup(std::uint64_t seed, const PanelMix& mix);

/// Draws a task that moves all joints within their limits.
tools::TaskModel random_task(const PanelRobot& kind, const tools::Robot& robot, double duration_s,
                             Draw& draw);

/// Outputs of the rigid body of `robot` along a motion; currents use the setup's constants.
Eigen::MatrixXd rigid_outputs(const PanelSetup& setup, const tools::Robot& robot, const MotionRows& motion);

/// Residuals of a real arm's joint currents after a regression on rigid-body torques, friction and offset.
/// One series per joint.
const std::vector<std::vector<double>>& real_residuals();

} // namespace dfdyn::tests
