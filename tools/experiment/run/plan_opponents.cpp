// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/run/plan_opponents.hpp"

#include "tools/base/text/error.hpp"
#include "tools/experiment/run/common_ticks.hpp"
#include "tools/experiment/run/train_case.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/replay/opponents/rigid_body.hpp"
#include "tools/robot/motion.hpp"
#include "tools/training/physics/torque_constants.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>

namespace dfdyn::tools {

namespace {

using ForecastsOf = std::function<Forecasts(const Recording&)>;

/// Returns the subset's measurements as a replay, for forecasts that use measurements only.
ReplayedRecording measurements(const Recording& subset) {
    ReplayedRecording replayed;
    replayed.measured = subset.output.values;
    return replayed;
}

OpponentErrors errors_of(const std::string& label, const Plan& plan, const PlanData& data,
                         const ForecastsOf& forecasts_of) {
    const std::size_t outputs = data.start.output.names.size();
    std::vector<OutputError> errors(outputs);
    for (const Recording& subset : data.subsets) {
        const Forecasts forecasts = forecasts_of(subset);
        for (std::size_t element = largest_window(plan) * outputs; element < forecasts.size(); ++element) {
            errors[element % outputs].add(subset.output.values[element], forecasts[element]);
        }
    }
    OpponentErrors result{label, {}};
    std::ranges::transform(errors, std::back_inserter(result.normalised_error), &OutputError::normalised);
    return result;
}

void check_fit(const Plan& plan, const Robot& robot, const Recording& recording) {
    const std::size_t joints = recording.joint_count();
    const std::size_t constants = plan.robot.torque_constants.size();
    if (robot.joints.size() != joints || (constants > 0 && constants != joints)) {
        throw InputError(
            "plan: robot: expected joints, and torque constants if any, as many as the recordings' " +
            std::to_string(joints) + ", found " + std::to_string(robot.joints.size()) + " and " +
            std::to_string(constants));
    }
}

/// Returns the outputs per N·m: from the plan's torque constants, or estimated as in training.
std::vector<double> output_gains(const Plan& plan, const Robot& robot, std::span<const Recording> training) {
    std::vector<double> gains(training.front().output.names.size(), 1);
    if (plan.outputs == OutputKind::motor_current && !plan.robot.torque_constants.empty()) {
        std::ranges::transform(plan.robot.torque_constants, gains.begin(),
                               [](double constant) { return 1 / constant; });
    } else if (plan.outputs == OutputKind::motor_current) {
        const RecordedMotion recorded = recorded_motion(training, rigid_body_window(training));
        TrainingData data;
        data.positions = recorded.motion.position;
        data.velocities = recorded.motion.velocity;
        data.accelerations = recorded.motion.acceleration;
        data.outputs = recorded.outputs;
        std::ranges::transform(estimate_torque_gains(robot, data, plan.robot.sign_velocity), gains.begin(),
                               &TorqueGain::gain);
    }
    return gains;
}

struct FittedBodies {
    ChainModel chain;
    std::vector<RigidBodyFit> fits;
};

/// Throws InputError if the plan has no usable robot, or the training data no motion.
FittedBodies fit_bodies(const Plan& plan, const PlanData& data) {
    if (plan.robot.urdf.empty()) {
        throw InputError("the plan has no robot");
    }
    const Robot robot = robot_of(plan.robot);
    check_fit(plan, robot, data.start);
    const Recording training[] = {data.start, data.online};
    FittedBodies bodies{chain_model(robot, plan.outputs), {}};
    bodies.fits = fit_rigid_body(robot, bodies.chain, output_gains(plan, robot, training),
                                 plan.robot.sign_velocity, training);
    if (bodies.fits.empty()) {
        throw InputError("the training log has no stretch without a gap that is long enough for derivatives");
    }
    return bodies;
}

} // namespace

PlanOpponents plan_opponents(const Plan& plan, const PlanData& data) {
    const std::size_t outputs = data.start.output.names.size();
    PlanOpponents opponents{
        {errors_of("persistence", plan, data,
                   [&](const Recording& subset) { return persistence(measurements(subset), outputs); }),
         errors_of("AR(2)", plan, data,
                   [&](const Recording& subset) { return autoregression(measurements(subset), outputs); })},
        {}};
    FittedBodies bodies;
    try {
        bodies = fit_bodies(plan, data);
    } catch (const InputError& error) {
        opponents.no_rigid_body = error.what();
    }
    const std::vector<double> none(outputs, std::numeric_limits<double>::quiet_NaN());
    for (const bool identified : {false, true}) {
        const std::string label = rigid_body_label(identified);
        const auto fit = std::ranges::find(bodies.fits, identified, &RigidBodyFit::identified);
        opponents.errors.push_back(fit == bodies.fits.end()
                                       ? OpponentErrors{label, none}
                                       : errors_of(label, plan, data, [&](const Recording& subset) {
                                             return rigid_body_forecasts(*fit, bodies.chain, subset);
                                         }));
    }
    return opponents;
}

} // namespace dfdyn::tools
