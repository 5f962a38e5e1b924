// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/run/plan_opponents.hpp"

#include "tools/base/text/error.hpp"
#include "tools/experiment/run/common_ticks.hpp"
#include "tools/experiment/run/train_case.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/replay/opponents/rigid_body.hpp"
#include "tools/robot/identification/torque_gains.hpp"
#include "tools/robot/motion.hpp"

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
std::vector<double> gains_of_plan(const Plan& plan, const Robot& robot, std::span<const Recording> training) {
    const auto estimate = [&] {
        return estimate_torque_gains(robot, recorded_motion(training, rigid_body_window(training)),
                                     plan.robot.sign_velocity);
    };
    return output_gains(torque_gains(robot, plan.outputs, plan.robot.torque_constants, estimate),
                        training.front().output.names.size());
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
    bodies.fits = fit_rigid_body(robot, bodies.chain, gains_of_plan(plan, robot, training),
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
