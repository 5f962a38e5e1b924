// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop_setup.hpp"

#include "tools/common/error.hpp"
#include "tools/common/number.hpp"

#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr double default_knot_s = 0.008;
constexpr double ramp_s = 0.2;
constexpr double largest_following_error_rad = 0.5;

JointVector torque_limit(const Robot& robot, const Scenario& scenario, const std::string& source) {
    if (scenario.actuators.torque_limit) {
        return *scenario.actuators.torque_limit;
    }
    JointVector limit(static_cast<Eigen::Index>(robot.joints.size()));
    for (Eigen::Index i = 0; i < limit.size(); ++i) {
        const RobotJoint& joint = robot.joints[static_cast<std::size_t>(i)];
        if (!joint.effort) {
            throw InputError(source + ": actuators.torque_limit_nm: expected a limit of joint " + joint.name +
                             ", for which the robot has none, found none");
        }
        limit[i] = *joint.effort;
    }
    return limit;
}

int knot_ticks(double period_s, double knot_s, const std::string& source) {
    const double ratio = knot_s / period_s;
    if (!(ratio >= 1 && std::abs(ratio - std::round(ratio)) < 1e-3)) {
        throw InputError(source + ": expected a sample period that is a multiple of the loop's " +
                         number_text(period_s) + " s, found " + number_text(knot_s) + " s");
    }
    return static_cast<int>(std::lround(ratio));
}

} // namespace

std::unique_ptr<ControlLoop> make_control_loop(const Robot& robot, const Scenario& scenario,
                                               const std::string& source, const LoopModel* learned,
                                               int delay_ticks) {
    const ControllerModel& controller = scenario.controller;
    if (controller.kind != ControllerKind::feed_forward) {
        throw InputError(source + ": controller.kind: expected feed_forward, found another");
    }
    const auto joints = static_cast<int>(robot.joints.size());
    LoopConfig config;
    config.period_s = 1 / controller.rate_hz;
    config.delay_ticks = delay_ticks;
    config.gains = {controller.position_gain, controller.velocity_gain};
    config.filter = scenario.derivatives;
    config.torque_limit = torque_limit(robot, scenario, source);
    config.safe_stop.following_error = JointVector::Constant(joints, largest_following_error_rad);
    config.safe_stop.ramp_ticks = static_cast<int>(std::ceil(ramp_s * controller.rate_hz));

    std::optional<LearnedFeedForward> model;
    double knot_s = default_knot_s;
    if (learned != nullptr) {
        model.emplace(learned->model, learned->from_prior, joints, learned->source);
        knot_s = model->sample_period_s();
    }
    config.knot_ticks = knot_ticks(config.period_s, knot_s, learned != nullptr ? learned->source : source);
    FeedForward feed_forward(robot, scenario.actuators.rotor_inertia, std::move(model),
                             config.knot_ticks * config.period_s);
    return std::make_unique<ControlLoop>(
        std::move(config), std::move(feed_forward),
        make_task(scenario.task, robot, 1 / controller.rate_hz, scenario.seed));
}

} // namespace dfdyn::tools
