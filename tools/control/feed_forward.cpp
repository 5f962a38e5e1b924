// SPDX-License-Identifier: Apache-2.0
#include "tools/control/feed_forward.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

Extent<dynamic> of(int size) { return Extent<dynamic>{size}; }

} // namespace

FeedForward::FeedForward(const Robot& nominal, const JointVector& rotor_inertia,
                         std::optional<LearnedFeedForward> learned, double knot_period_s)
    : dynamics_(nominal, rotor_inertia), learned_(std::move(learned)),
      memory_(std::max(1, static_cast<int>(std::lround(1 / knot_period_s)))),
      combination_(of(2), of(dynamics_.joint_count()), memory_),
      forecasts_(2 * static_cast<std::size_t>(dynamics_.joint_count())) {}

JointVector FeedForward::nominal_torque(const Reference& reference) {
    dynamics_.configure(reference.position, configuration_);
    return dynamics_.inverse(configuration_, reference.velocity, reference.acceleration);
}

JointVector FeedForward::gravity(const JointVector& position) {
    const JointVector rest = JointVector::Zero(position.size());
    return nominal_torque({position, rest, rest});
}

void FeedForward::begin(std::int64_t time_ns, const Reference& start) {
    combination_.restart();
    judged_ = 0;
    known_ = false;
    if (learned_) {
        learned_->begin(time_ns, start.position);
    }
    nominal_now_ = learned_now_ = from_ = to_ = nominal_torque(start);
}

void FeedForward::judge(const JointVector& torque) {
    std::ranges::copy(nominal_now_, forecasts_.begin());
    std::ranges::copy(learned_now_, forecasts_.begin() + nominal_now_.size());
    combination_.learn(forecasts_.data(), torque.data());
    ++judged_;
}

void FeedForward::measured(std::int64_t time_ns, const JointVector& position, const JointVector* torque) {
    if (!learned_) {
        return;
    }
    if (known_ && torque != nullptr) {
        judge(*torque);
    }
    learned_->learn(time_ns, position, torque);
}

void FeedForward::go_on() {
    if (learned_) {
        learned_->go_on();
    }
}

void FeedForward::advance(std::int64_t next_ns, const Reference& next) {
    from_ = to_;
    nominal_now_ = to_ = nominal_torque(next);
    known_ = learned_ && learned_->predict(next_ns, next.position, learned_now_);
    if (known_ && trusted()) {
        const JointVector share = learned_share();
        to_ += share.cwiseProduct(learned_now_ - nominal_now_);
    }
}

JointVector FeedForward::holding(const Reference& reference) {
    const JointVector torque = nominal_torque(reference);
    if (!trusted()) {
        return torque;
    }
    if (held_learned_.size() == 0) {
        held_learned_ = to_ - nominal_now_;
    }
    JointVector learned;
    if (learned_->rest(reference.position, learned)) {
        held_learned_ = learned_share().cwiseProduct(learned - gravity(reference.position));
    }
    return torque + held_learned_;
}

JointVector FeedForward::learned_share() const {
    if (!trusted()) {
        return JointVector::Zero(dynamics_.joint_count());
    }
    return Eigen::Map<const Eigen::VectorXd>(combination_.weights() + dynamics_.joint_count(),
                                             dynamics_.joint_count());
}

} // namespace dfdyn::tools
