// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel_case.hpp"
#include "tests/diagnosis/panel_random.hpp"
#include "tools/simulation/scenario/scenario.hpp"

#include <Eigen/Core>

namespace dfdyn::tests {

/// Of a link's mass, where masses are off.
inline constexpr double largest_mass_error = 0.1;

/// One of the panel's arms with one kind of outputs.
struct PanelRobot {
    std::string name, urdf, tip;
    tools::OutputKind outputs;
    double speed;         ///< rad/s, of its joints at most
    double largest_range; ///< rad, of the motion of a joint to both sides of its centre
};

const std::vector<PanelRobot>& panel_robots();
const PanelRobot& panel_robot(const std::string& name);
tools::Robot read_panel_robot(const PanelRobot& robot);

/// Joint motion or outputs: one row per instant.
struct MotionRows {
    Eigen::MatrixXd position, velocity, acceleration;
};

/// An arm in motion before anything is hidden, and the noise of its outputs.
struct PanelSetup {
    PanelRobot kind;
    tools::Robot robot;   ///< as it truly is
    tools::Robot nominal; ///< as it is believed to be
    bool masses_off = false;
    std::vector<double> mass_errors; ///< per link: nominal over true, minus 1
    tools::Scenario scenario;        ///< without noise
    bool constants_known = true;
    Eigen::VectorXd torque_constants; ///< N·m/A; ones where the outputs are not currents
    MotionRows reference;             ///< the task's, 50 rows per second
    Eigen::MatrixXd reference_output;
    std::string noise;
    Eigen::MatrixXd noise_rows; ///< of the recording, in its units
    Eigen::VectorXd noise_rms, noise_in_band;
    double duration_s = 0;

    Eigen::Index outputs() const { return noise_rms.size(); }
    Eigen::Index joints() const { return static_cast<Eigen::Index>(robot.joints.size()); }
    bool wrench() const { return kind.outputs == tools::OutputKind::wrench; }
    std::string output_name(Eigen::Index output) const;
};

PanelSetup make_panel_setup(std::uint64_t seed, const PanelMix& mix);

/// A task that moves all joints within their limits.
tools::TaskModel random_task(const PanelRobot& kind, const tools::Robot& robot, double duration_s,
                             Draw& draw);

/// What the rigid body of `robot` shows on the outputs along a motion; currents by the setup's constants.
Eigen::MatrixXd rigid_outputs(const PanelSetup& setup, const tools::Robot& robot, const MotionRows& motion);

/// Residuals of real joints' currents, one series per joint: what a regression on their rigid torques,
/// friction and offset leaves.
const std::vector<std::vector<double>>& real_residuals();

} // namespace dfdyn::tests
