// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/task/circle_task.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/simulation/random_streams.hpp"

#include <cmath>
#include <numbers>

namespace dfdyn::tools {

SlowVariation::SlowVariation(double size, double time_constant_s, double period_s)
    : size_(size), left_(std::exp(-period_s / time_constant_s)), period_s_(period_s) {}

void SlowVariation::advance(NormalSource& source) {
    first_ = left_ * first_ + std::sqrt(1 - left_ * left_) * source.next();
    second_ = left_ * second_ + (1 - left_) * first_;
    // the second low pass halves the variance
    const double value = size_ * std::numbers::sqrt2 * second_;
    rate_ = (value - value_) / period_s_;
    value_ = value;
}

Circle::Circle(const CircleTask& model, const Robot& robot, double period_s, std::uint64_t seed)
    : model_(model), period_s_(period_s), kinematics_(robot), source_(seed, stream::task),
      speed_(model.speed_variation, model.variation_time_s, period_s),
      centre_{SlowVariation(model.centre_variation, model.variation_time_s, period_s),
              SlowVariation(model.centre_variation, model.variation_time_s, period_s),
              SlowVariation(model.centre_variation, model.variation_time_s, period_s)},
      posture_(robot.joints.size(),
               SlowVariation(model.posture_variation, model.variation_time_s, period_s)) {
    position_ = kinematics_.reach(model.rest_posture, point(0), model.rest_posture);
    velocity_ = acceleration_ = JointVector::Zero(position_.size());
    check_reach();
}

Eigen::Vector3d Circle::point(double angle) const {
    Eigen::Vector3d result = model_.centre;
    result[model_.first_axis] += model_.radius * std::cos(angle);
    result[model_.second_axis] += model_.radius * std::sin(angle);
    return result;
}

Eigen::Vector3d Circle::tangent(double angle) const {
    return point(angle + std::numbers::pi / 2) - model_.centre;
}

void Circle::check_reach() {
    constexpr int points = 72;
    constexpr double tolerance = 1e-4; // m
    JointVector posture = position_;
    for (int i = 0; i < points; ++i) {
        const double angle = 2 * std::numbers::pi * i / points;
        posture = kinematics_.reach(posture, point(angle), model_.rest_posture);
        const double miss = (kinematics_.tip(posture) - point(angle)).norm();
        if (!(miss <= tolerance)) {
            throw InputError("task.circle: at " + number_text(std::round(angle * 180 / std::numbers::pi)) +
                             " degrees: expected a point within reach of the tip, found one " +
                             number_text(std::round(miss * 1e4) / 10) + " mm out of reach (" +
                             kinematics_.joints_at_limits(posture) + ")");
        }
    }
}

void Circle::wander() {
    speed_.advance(source_);
    for (SlowVariation& coordinate : centre_) {
        coordinate.advance(source_);
    }
    for (SlowVariation& joint : posture_) {
        joint.advance(source_);
    }
    const double start = smooth_step(static_cast<double>(step_) * period_s_, model_.start_s).value;
    angle_rate_ = 2 * std::numbers::pi / model_.period_s * start * (1 + speed_.value());
}

JointVector Circle::joint_velocity() {
    constexpr double feedback = 20; // 1/s
    constexpr double approach = 10; // 1/s, to a joint's limit
    Eigen::Vector3d target = point(angle_);
    Eigen::Vector3d tip_velocity = angle_rate_ * tangent(angle_);
    for (Eigen::Index i = 0; i < 3; ++i) {
        target[i] += centre_[static_cast<std::size_t>(i)].value();
        tip_velocity[i] += centre_[static_cast<std::size_t>(i)].rate();
    }
    JointVector pull = model_.rest_posture - position_;
    for (Eigen::Index i = 0; i < pull.size(); ++i) {
        pull[i] += posture_[static_cast<std::size_t>(i)].value();
    }
    const Eigen::Vector3d miss = target - kinematics_.tip(position_);
    return kinematics_.move(position_, tip_velocity + feedback * miss, model_.rest_pull * pull, approach);
}

Reference Circle::next() {
    if (step_++ == 0) {
        return {position_, velocity_, acceleration_};
    }
    position_ += period_s_ * (velocity_ + period_s_ / 2 * acceleration_);
    angle_ += period_s_ * angle_rate_;
    wander();
    const JointVector velocity = joint_velocity();
    acceleration_ = (velocity - velocity_) / period_s_;
    velocity_ = velocity;
    return {position_, velocity_, acceleration_};
}

} // namespace dfdyn::tools
