// SPDX-License-Identifier: Apache-2.0
#include "tools/control/observer_bandwidth.hpp"

#include "dfdyn/control/loop_margin.hpp"
#include "tools/robot/dynamics/arm_dynamics.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

namespace dfdyn::tools {

namespace {

/// Inertia of each joint (links and rotor), kg·m² or kg.
struct InertiaRange {
    JointVector start; ///< with the other joints locked, at the start of the motion
    JointVector least; ///< smallest during the motion, as the other joints move
    JointVector most;  ///< largest during the motion
};

/// Inertias that the joints' feedbacks move together. With gains in proportion to the joints' own inertias J,
/// the eigenvectors of J^½ M⁻¹ J^½ are independent, and each has J divided by its eigenvalue. A joint has
/// those of the eigenvectors in which it moves.
InertiaRange inertia_of_modes(const JointMatrix& mass) {
    constexpr double least_share = 0.05; // of an eigenvector's kinetic energy
    const JointVector own = mass.diagonal(), root = own.cwiseSqrt();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(root.asDiagonal() * mass.inverse() *
                                                               root.asDiagonal());
    InertiaRange range{own, own, own};
    for (Eigen::Index mode = 0; mode < own.size(); ++mode) {
        for (Eigen::Index joint = 0; joint < own.size(); ++joint) {
            const double share = modes.eigenvectors()(joint, mode);
            if (share * share >= least_share) {
                const double inertia = own[joint] / modes.eigenvalues()[mode];
                range.least[joint] = std::min(range.least[joint], inertia);
                range.most[joint] = std::max(range.most[joint], inertia);
            }
        }
    }
    return range;
}

/// Evaluates the first 20 s of the motion, four times per second.
InertiaRange inertia_of_motion(const Robot& robot, const Scenario& scenario) {
    constexpr double duration_s = 20, step_s = 0.25;
    const double rate_hz = scenario.controller.rate_hz;
    const auto ticks = static_cast<int>(duration_s * rate_hz);
    const int step = std::max(1, static_cast<int>(step_s * rate_hz));
    const ArmDynamics dynamics(robot, scenario.actuators.rotor_inertia);
    const std::unique_ptr<Task> task = make_task(scenario.task, robot, 1 / rate_hz, scenario.seed);
    ArmDynamics::Configuration configuration;
    InertiaRange range;
    for (int tick = 0; tick <= ticks; ++tick) {
        const JointVector position = task->next().position;
        if (tick % step != 0) {
            continue;
        }
        dynamics.configure(position, configuration);
        const InertiaRange here = inertia_of_modes(dynamics.mass_matrix(configuration));
        if (tick == 0) {
            range = here;
        }
        range.least = range.least.cwiseMin(here.least);
        range.most = range.most.cwiseMax(here.most);
    }
    return range;
}

} // namespace

DerivativeModel loop_filter(const Scenario& scenario) {
    DerivativeModel filter = scenario.derivatives;
    const double readings = filter.velocity_window * scenario.controller.rate_hz / filter.rate_hz;
    filter.velocity_window = std::max(2, static_cast<int>(std::lround(readings)));
    filter.rate_hz = scenario.controller.rate_hz;
    return filter;
}

JointVector default_bandwidth(const Robot& robot, const Scenario& scenario, int delay_ticks) {
    constexpr double degree = std::numbers::pi / 180, margin = 20 * degree, extreme_margin = 10 * degree;
    constexpr double most = 40, window_share = 0.5;
    const ControllerModel& controller = scenario.controller;
    const DerivativeModel filter = loop_filter(scenario);
    const InertiaRange inertia = inertia_of_motion(robot, scenario);
    JointVector bandwidth = inertia.start;
    for (Eigen::Index i = 0; i < bandwidth.size(); ++i) {
        const double start = inertia.start[i];
        bandwidth[i] = most;
        for (const auto& [true_inertia, margin_rad] :
             {std::pair(0.6 * start, margin), std::pair(start, margin), std::pair(2 * start, margin),
              std::pair(inertia.least[i], extreme_margin), std::pair(inertia.most[i], extreme_margin)}) {
            const JointLoop<double> loop{true_inertia, controller.position_gain[i],
                                         controller.velocity_gain[i],
                                         (delay_ticks + 0.5) / controller.rate_hz,
                                         window_share * filter.velocity_window / filter.rate_hz / 2};
            bandwidth[i] =
                std::min(bandwidth[i], LoopMargin(loop, start).largest_bandwidth(margin_rad, most));
        }
    }
    return bandwidth;
}

} // namespace dfdyn::tools
