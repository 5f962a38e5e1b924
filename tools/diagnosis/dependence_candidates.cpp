// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidate_parts.hpp"
#include "tools/diagnosis/candidates.hpp"
#include "tools/diagnosis/smooth_functions.hpp"

namespace dfdyn::tools {

namespace {

/// Odds against a cause that nobody has a name for, where a named one explains as much.
constexpr double price_of_no_name = 4;

/// What outputs may depend on: one joint's motion, by functions of each.
struct JointInputs {
    std::string position_name, velocity_name;
    Eigen::VectorXd velocity, direction;
    std::vector<Eigen::VectorXd> of_position;

    JointInputs(const DiagnosisSignals& signals, Eigen::Index joint)
        : position_name(numbered("q", static_cast<std::size_t>(joint))),
          velocity_name(numbered("qd", static_cast<std::size_t>(joint))),
          velocity(signals.measured.motion.velocity.col(joint)),
          direction((velocity.array() / signals.sign_velocity[joint]).tanh()),
          of_position(harmonics(signals.measured.motion.position.col(joint), 5)) {}
};

Candidate without_name(Eigen::Index output, std::vector<std::string> inputs) {
    Candidate result;
    result.where = numbered("output", static_cast<std::size_t>(output));
    result.inputs = std::move(inputs);
    for (const std::string& input : result.inputs) {
        result.detail += input;
    }
    result.extra_price = price_of_no_name;
    return result;
}

void add_shape(Candidate& candidate, std::vector<std::size_t> columns) {
    candidate.shapes.push_back({std::move(columns), is_anything, 0});
}

Candidate of_position(Eigen::Index output, const JointInputs& joint) {
    Candidate result = without_name(output, {joint.position_name});
    for (const Eigen::VectorXd& function : joint.of_position) {
        result.columns.push_back(on_output(output, function));
    }
    add_shape(result, {0, 1, 2, 3});
    add_shape(result, {0, 1, 2, 3, 4, 5});
    add_shape(result, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
    return result;
}

/// `own`: friction of its own joint has a name; what is the same in both directions has none.
Candidate of_velocity(Eigen::Index output, const JointInputs& joint, bool own) {
    Candidate result = without_name(output, {joint.velocity_name});
    for (const Eigen::VectorXd& function :
         {joint.velocity.cwiseAbs2().eval(), joint.velocity.cwiseAbs().eval(), joint.velocity,
          joint.direction}) {
        result.columns.push_back(on_output(output, function));
    }
    add_shape(result, {0});
    add_shape(result, {1});
    if (!own) {
        add_shape(result, {2});
        add_shape(result, {3});
        add_shape(result, {2, 3});
    }
    return result;
}

/// Friction of a joint that is not the same everywhere.
Candidate of_position_and_velocity(Eigen::Index output, const JointInputs& joint) {
    Candidate result = without_name(output, {joint.position_name, joint.velocity_name});
    for (const Eigen::VectorXd& friction : {joint.velocity, joint.direction}) {
        for (std::size_t i = 0; i < 4; ++i) {
            result.columns.push_back(on_output(output, friction.cwiseProduct(joint.of_position[i])));
        }
    }
    add_shape(result, {0, 1});
    add_shape(result, {4, 5});
    add_shape(result, {0, 1, 2, 3});
    add_shape(result, {4, 5, 6, 7});
    return result;
}

} // namespace

std::vector<Candidate> dependence_candidates(const DiagnosisSignals& signals) {
    std::vector<Candidate> result;
    for (Eigen::Index number = 0; number < static_cast<Eigen::Index>(signals.joints()); ++number) {
        const JointInputs joint(signals, number);
        for (Eigen::Index output = 0; output < signals.outputs(); ++output) {
            const bool own = !signals.wrench() && output == number;
            result.push_back(of_position(output, joint));
            result.push_back(of_velocity(output, joint, own));
            if (own) {
                result.push_back(of_position_and_velocity(output, joint));
            }
        }
    }
    return result;
}

} // namespace dfdyn::tools
