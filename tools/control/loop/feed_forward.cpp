// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/feed_forward.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace dfdyn::tools {

Storage<double, dynamic> torques(const JointVector& values) {
    auto result = Storage<double, dynamic>::zeros({static_cast<int>(values.size())});
    std::ranges::copy(values, result.begin());
    return result;
}

JointVector joint_vector(const Storage<double, dynamic>& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), values.size());
}

FeedForward::FeedForward(const Robot& nominal, const JointVector& rotor_inertia,
                         std::optional<LearnedFeedForward> learned, double period_s, int knot_ticks,
                         const JointVector& limit, const JointVector& learned_limit,
                         const JointVector& bandwidth, const JointVector& observer_limit)
    : dynamics_(nominal, rotor_inertia), knot_ticks_(knot_ticks), cap_(learned_limit), period_s_(period_s),
      compensation_(JointVector::Zero(limit.size())), wanted_compensation_(compensation_),
      inertia_(JointVector::Zero(dynamics_.joint_count())) {
    constexpr double full_scale_s = 0.05;
    if (learned) {
        learned_ = std::make_unique<LearnedFeedForward>(std::move(*learned));
        core_.emplace(*learned_, Core::Settings{.period_ns = std::llround(period_s * 1e9),
                                                .ticks_per_sample = knot_ticks,
                                                .limit = torques(limit),
                                                .cap = torques(cap_),
                                                .rate = torques(limit / full_scale_s),
                                                .bandwidth = torques(bandwidth),
                                                .observer_limit = torques(observer_limit)});
        reference_ = {torques(inertia_), torques(inertia_), torques(inertia_)};
    }
}

JointVector FeedForward::nominal_torque(const Reference& reference) {
    dynamics_.configure(reference.position, configuration_);
    return dynamics_.inverse(configuration_, reference.velocity, reference.acceleration) + compensation_;
}

void FeedForward::compensate(std::span<const double> torque) {
    wanted_compensation_ += Eigen::Map<const Eigen::VectorXd>(torque.data(), wanted_compensation_.size());
    wanted_compensation_ = wanted_compensation_.cwiseMin(cap_).cwiseMax(-cap_);
}

JointVector FeedForward::gravity(const JointVector& position) {
    const JointVector rest = JointVector::Zero(position.size());
    return nominal_torque({position, rest, rest});
}

void FeedForward::enable_learned(bool on) noexcept {
    if (core_) {
        core_->enable(on);
    }
}

void FeedForward::observer_bandwidth_share(const Storage<double, dynamic>& share) {
    for (int joint = 0; core_ && joint < share.size(); ++joint) {
        core_->observer_bandwidth_share(joint, share[joint]);
    }
}

void FeedForward::begin(std::int64_t time_ns, const Reference& start) {
    tick_ = 0;
    if (core_) {
        core_->begin(time_ns, start.position.data());
    }
}

JointVector FeedForward::update(const Reference& reference) {
    compensation_ += period_s_ / compensation_s * (wanted_compensation_ - compensation_);
    JointVector nominal = nominal_torque(reference);
    if (tick_++ % knot_ticks_ == 0) {
        inertia_ = dynamics_.mass_matrix(configuration_).diagonal();
    }
    if (!core_) {
        return nominal;
    }
    std::ranges::copy(reference.position, reference_.position.begin());
    std::ranges::copy(reference.velocity, reference_.velocity.begin());
    std::ranges::copy(reference.acceleration, reference_.acceleration.begin());
    return joint_vector(core_->update(reference_, nominal.data()));
}

void FeedForward::commanded(const JointVector& torque) {
    if (core_) {
        core_->commanded(torque.data());
    }
}

void FeedForward::measured(std::int64_t time_ns, const JointVector* position, const JointVector* torque,
                           bool may_learn) {
    if (core_) {
        learned_->may_learn(may_learn);
        core_->measured(time_ns, position != nullptr ? position->data() : nullptr,
                        torque != nullptr ? torque->data() : nullptr);
    }
}

JointVector FeedForward::holding(const Reference& reference) {
    JointVector torque = nominal_torque(reference);
    if (!core_) {
        return torque;
    }
    if (held_learned_.size() == 0) {
        held_learned_ = joint_vector(core_->learned_part());
    }
    const std::span<const double> forecasts = learned_->rest(reference.position);
    if (!forecasts.empty()) {
        const JointVector at_rest = gravity(reference.position);
        JointVector holding(torque.size());
        core_->combine(forecasts.data(), at_rest.data(), holding.data());
        held_learned_ = holding - at_rest;
    }
    return torque + held_learned_;
}

JointVector FeedForward::learned_share() const {
    return core_ ? joint_vector(core_->share()) : JointVector::Zero(dynamics_.joint_count());
}

} // namespace dfdyn::tools
