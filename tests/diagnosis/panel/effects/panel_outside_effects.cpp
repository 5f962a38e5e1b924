// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/effects/panel_effect.hpp"

#include <cmath>

namespace dfdyn::tests {

using namespace tools;

namespace {

using Law = std::function<double(const JointVector& position, const JointVector& velocity)>;

/// Torque that opposes a joint, per unit of size.
struct OutsideLaw {
    Law law;
    std::string depends_on;
    EffectParameters shape;
};

std::string input(const char* what, Eigen::Index joint) { return what + std::to_string(joint + 1); }

/// Friction that grows with the distance from a centre.
OutsideLaw position_dependent_friction(const EffectDraw& of, Eigen::Index joint) {
    const double middle = of.setup.reference.position.col(joint).mean();
    return {[joint, middle](const JointVector& q, const JointVector& v) {
                return (q[joint] - middle) * v[joint];
            },
            input("q", joint),
            {{"middle", middle}}};
}

/// A cable that pulls back beyond an angle, with increasing stiffness.
OutsideLaw catching_cable(const EffectDraw& of, Eigen::Index joint) {
    const Eigen::VectorXd position = of.setup.reference.position.col(joint);
    const double low = position.minCoeff();
    const double high = position.maxCoeff();
    const double from = low + of.draw.uniform(0.55, 0.75) * (high - low);
    return {[joint, from](const JointVector& q, const JointVector&) {
                const double stretch = std::max(0.0, q[joint] - from);
                return stretch * stretch * stretch;
            },
            input("q", joint),
            {{"from", from}}};
}

/// The square of another joint's velocity, as from an unbalanced rotor.
OutsideLaw velocity_squared_coupling(const EffectDraw&, Eigen::Index joint, Eigen::Index other) {
    return {[other](const JointVector&, const JointVector& v) { return v[other] * v[other]; },
            input("qd", other),
            {{"joint", static_cast<double>(joint + 1)}, {"other", static_cast<double>(other + 1)}}};
}

/// Friction in this joint caused by another joint's motion, as from a belt that runs through it.
OutsideLaw cross_joint_friction(const EffectDraw&, Eigen::Index joint, Eigen::Index other) {
    return {[other](const JointVector&, const JointVector& v) { return std::tanh(v[other] / 0.05); },
            input("qd", other),
            {{"joint", static_cast<double>(joint + 1)}, {"other", static_cast<double>(other + 1)}}};
}

std::optional<OutsideLaw> law_of(const std::string& name, const EffectDraw& of, Eigen::Index joint) {
    const Eigen::Index other =
        (joint + of.draw.whole(1, static_cast<int>(of.setup.joints()) - 1)) % of.setup.joints();
    if (name == "position_dependent_friction") {
        return position_dependent_friction(of, joint);
    }
    if (name == "catching_cable") {
        return catching_cable(of, joint);
    }
    if (name == "velocity_squared_coupling") {
        return velocity_squared_coupling(of, joint, other);
    }
    if (name == "cross_joint_friction") {
        return cross_joint_friction(of, joint, other);
    }
    return std::nullopt;
}

double law_rms(const PanelSetup& setup, const Law& law) {
    const MotionRows& motion = setup.reference;
    double squares = 0;
    for (Eigen::Index row = 0; row < motion.position.rows(); ++row) {
        squares +=
            std::pow(law(motion.position.row(row).transpose(), motion.velocity.row(row).transpose()), 2);
    }
    return std::sqrt(squares / static_cast<double>(motion.position.rows()));
}

} // namespace

std::vector<std::string> outside_effect_names() {
    return {"position_dependent_friction", "catching_cable", "velocity_squared_coupling",
            "cross_joint_friction"};
}

std::optional<DrawnEffect> draw_outside_effect(const std::string& name, const EffectDraw& of) {
    const Eigen::Index joint = of.joint();
    const std::optional<OutsideLaw> outside = law_of(name, of, joint);
    if (!outside) {
        return std::nullopt;
    }
    const double size = of.wanted(joint) / law_rms(of.setup, outside->law);
    DrawnEffect effect;
    effect.where = joint_place(joint);
    effect.depends_on = outside->depends_on;
    effect.hide = [joint, law = outside->law](double factor, Scenario& scenario) {
        const auto before = scenario.loads.further;
        scenario.loads.further = [=](const JointVector& q, const JointVector& v) {
            JointVector torque = before ? before(q, v) : JointVector(JointVector::Zero(q.size()));
            torque[joint] -= factor * law(q, v);
            return torque;
        };
    };
    effect.parameters = [shape = outside->shape](double factor) {
        EffectParameters parameters{{"size", factor}};
        parameters.insert(parameters.end(), shape.begin(), shape.end());
        return parameters;
    };
    effect.guess = std::isfinite(size) ? size : 0;
    effect.largest = 1e4;
    return effect;
}

} // namespace dfdyn::tests
