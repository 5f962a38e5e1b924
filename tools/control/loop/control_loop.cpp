// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/control_loop.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

/// A position with a value that is not finite counts as missing.
bool has_position(const LoopInput& input) { return input.position != nullptr && input.position->allFinite(); }

void set_missing(const std::vector<bool>* from, std::vector<bool>& missing) {
    if (from != nullptr) {
        missing = *from;
    } else {
        missing.assign(missing.size(), false);
    }
}

DisturbanceObserver<double, dynamic> make_observer(const LoopConfig& config) {
    const JointVector& limit = config.torque_limit;
    const bool none = config.bandwidth.size() == 0;
    return {{static_cast<int>(limit.size())},
            {config.period_s, torques(none ? JointVector::Zero(limit.size()) : config.bandwidth),
             torques(ControlLoop::observer_share * limit), torques(ControlLoop::observer_step * limit),
             torques(ControlLoop::vibration_swing * limit)}};
}

} // namespace

ControlLoop::ControlLoop(LoopConfig config, FeedForward feed_forward, std::unique_ptr<Task> task)
    : config_(std::move(config)), feed_forward_(std::move(feed_forward)),
      feedback_(config_.gains, config_.filter, config_.period_s,
                {config_.safe_stop.speed_limit, config_.safe_stop.acceleration}),
      clock_(std::llround(config_.period_s * 1e9)), watch_(config_.safe_stop, config_.period_s),
      safe_stop_(config_.safe_stop), task_(std::move(task), config_.period_s),
      observer_(make_observer(config_)), zero_(JointVector::Zero(config_.torque_limit.size())), error_(zero_),
      command_(zero_), excess_(zero_), feedback_torque_(zero_),
      missing_(static_cast<std::size_t>(zero_.size())), blind_(missing_.size()), unsettled_(missing_.size()) {
    early_.position = zero_;
    early_.missing = missing_;
    references_.assign(std::size_t{1} + static_cast<std::size_t>(config_.delay_ticks) + SampleClock::max_age,
                       task_.next());
    commands_.resize(references_.size());
}

const Reference& ControlLoop::measured_reference(int ago) const noexcept {
    const std::size_t delay = std::min(tick_, static_cast<std::size_t>(config_.delay_ticks + ago));
    return references_[(tick_ - delay) % references_.size()];
}

const JointVector& ControlLoop::tick(const LoopInput& input) {
    ++counters_.ticks;
    told_ = told_ || input.stop_requested;
    position_tick_ = has_position(input) ? counters_.ticks : position_tick_;
    if (state() == LoopState::running) { // the reference advances with time, not with measurements
        ++tick_;
        references_[tick_ % references_.size()] = rest_.position.size() > 0 ? rest_ : task_.next();
    }
    sense(input);
    if (feedback_.position().size() > 0) {
        error_ = feedback_.error();
        watch_.move(feedback_, command_);
    }
    const bool found = actions_.stop().has_value();
    const StopCause joint = watch_.cause() == StopCause::none && found ? StopCause::finding : watch_.cause();
    const LoopState state = safe_stop_.tick(
        {feedback_.complete(), input.deadline_missed, input.bus_lost, input.stop_requested, input.returning,
         joint, feedback_.longest_silence(), watch_.joint(), feedback_.silent_joint()},
        yields_ ? zero_ : error_);
    if (state == LoopState::running) {
        follow();
    } else if (state != LoopState::waiting && moved()) {
        hold();
    }
    return command_;
}

void ControlLoop::sense(const LoopInput& input) {
    clock_.advance();
    feedback_.advance();
    learnable_ago_.reset();
    std::optional<int> place;
    if (has_position(input)) {
        place = clock_.place(input.time_ns, input.deadline_missed);
    }
    if (place && *place <= 0) {
        take(-*place, *input.position, input.missing);
    } else if (early_.tick == counters_.ticks && (early_.found_late || !has_position(input))) {
        take(0, early_.position, &early_.missing);
    }
    if (place && *place > 0) {
        early_.tick = counters_.ticks + static_cast<std::uint64_t>(*place);
        early_.position = *input.position;
        early_.found_late = input.deadline_missed;
        set_missing(input.missing, early_.missing);
    }
}

void ControlLoop::take(int ticks_ago, const JointVector& position, const std::vector<bool>* missing) {
    set_missing(missing, missing_);
    const Reference& reference = measured_reference(ticks_ago);
    watch_.read(position, reference.position, feedback_, missing_);
    for (std::size_t joint = 0; joint < missing_.size(); ++joint) {
        missing_[joint] = missing_[joint] || watch_.repeated()[joint];
    }
    feedback_.observe(ticks_ago, position, reference, &missing_);
    if (feedback_.regular()) {
        learnable_ago_ = ticks_ago;
    }
}

void ControlLoop::begin() {
    const JointVector offset = -error_;
    const auto pull = config_.gains.position.cwiseProduct(offset).cwiseAbs().array();
    if ((pull > recovery_step * config_.torque_limit.array()).any()) {
        move_reference(offset);
        task_.lead_in(offset, config_.safe_stop.speed_limit);
        error_ = zero_;
    }
    start_ns_ = clock_.expected_ns();
    feed_forward_.begin(start_ns_, reference());
    observer_.restart();
}

void ControlLoop::follow() {
    if (!moved()) {
        begin();
    }
    ++counters_.running;
    counters_.coasted += feedback_.complete() ? 0 : 1;
    const JointVector forward = feed_forward_.update(reference());
    JointVector unlimited;
    if (touched_) {
        command_ = unlimited = slowly(compliant_torque());
    } else {
        const JointVector wanted = feedback_.torque() + disturbance();
        command_ = forward + gradually(wanted);
        unlimited = forward + wanted;
    }
    counters_.limited += limit() ? 1 : 0;
    excess_ = unlimited - command_;
    feedback_torque_ = command_ - forward;
    if (!touched_) {
        feed_forward_.commanded(required_torque());
    }
    learn();
    commands_[tick_ % commands_.size()] = {command_, excess_.isZero(0) && feedback_.regular()};
    act();
    meet_contact();
}

JointVector ControlLoop::of_regular_joints(JointVector torque) const {
    for (Eigen::Index joint = 0; joint < torque.size(); ++joint) {
        torque[joint] = feedback_.regular(joint) ? torque[joint] : unknown_torque;
    }
    return torque;
}

JointVector ControlLoop::required_torque() const {
    JointVector torque = of_regular_joints(command_);
    for (Eigen::Index joint = 0; joint < torque.size(); ++joint) {
        torque[joint] = excess_[joint] == 0 ? torque[joint] : unknown_torque;
    }
    return torque;
}

void ControlLoop::learn() {
    sample_age_ = learnable_ago_.value_or(sample_age_);
    const int ago = learnable_ago_.value_or(0);
    const std::int64_t at = static_cast<std::int64_t>(tick_) - ago;
    const bool fresh = at > passed_tick_ || config_.knot_ticks > 1; // with knots no stamp is taken twice
    // a lost cycle is bridged: otherwise learning and contacts would pause for the length of the window
    const bool bridged = fresh && !learnable_ago_ && sample_age_ == 0 && feedback_.known();
    const JointVector position =
        bridged ? JointVector(measured_reference().position - feedback_.error()) : feedback_.position();
    const bool measured = bridged || (fresh && learnable_ago_);
    const Sent* const then = command_then(ago);
    passed_tick_ = measured ? at : passed_tick_;
    feed_forward_.measured(start_ns_ + std::llround(static_cast<double>(at) * config_.period_s * 1e9),
                           measured ? &position : nullptr, then != nullptr ? &then->torque : nullptr,
                           !bridged && then != nullptr && then->full);
}

void ControlLoop::meet_contact() {
    const int joint = feed_forward_.contact_joint();
    const bool contact = joint >= 0;
    const FindingAction action = config_.on_contact;
    calm_for_s_ = contact ? 0 : calm_for_s_ + config_.period_s;
    const bool begins = action == FindingAction::yield ? !yields_ : !touched_;
    if (contact && begins && action != FindingAction::report) {
        actions_.add({time_s(), Cause::contact, joint, action});
    }
    if (contact && !touched_ && (action == FindingAction::hold || action == FindingAction::yield)) {
        touched_ = true;
        task_.pause();
        observer_.restart(); // its disturbance contains the push
    }
    if (action == FindingAction::yield) {
        yield(contact);
    }
}

void ControlLoop::yield(bool contact) {
    if (yields_ && calm_for_s_ >= calm_s) {
        rest_here();
    }
    yields_ = contact || (yields_ && calm_for_s_ < calm_s);
}

void ControlLoop::move_reference(const JointVector& distance) {
    for (Reference& reference : references_) { // the whole ring: the readings of a delay belong to it, too
        reference.position += distance;
    }
    feedback_.move_reference(distance);
    watch_.move_reference(distance);
}

void ControlLoop::rest_here() {
    move_reference(feedback_.position() - reference().position);
    rest_ = {reference().position, zero_, zero_};
}

JointVector ControlLoop::compliant_torque() {
    JointVector torque = feed_forward_.gravity(feedback_.position());
    if (!yields_) {
        torque += feedback_.torque();
    } else if (calm_for_s_ > 0) { // the reference rests: this brakes the arm
        torque += config_.gains.velocity.cwiseProduct(feedback_.error_rate());
    }
    return torque;
}

JointVector ControlLoop::slowly(const JointVector& torque) const {
    const JointVector step = config_.period_s / stop_time_s * config_.torque_limit;
    return torque.cwiseMin(command_ + step).cwiseMax(command_ - step);
}

void ControlLoop::act() {
    const Verdict* const verdict = feed_forward_.take_verdict();
    if (verdict == nullptr) {
        return;
    }
    const FindingAction action = config_.actions.of(verdict->cause);
    const std::uint32_t cause = std::uint32_t{1} << static_cast<unsigned>(verdict->cause);
    const bool again = verdict->number == acted_number_ && (acted_on_ & cause) != 0;
    if (action == FindingAction::report || again ||
        verdict->confidence < FindingActions::least_confidence(action)) {
        return;
    }
    acted_on_ = verdict->number == acted_number_ ? acted_on_ | cause : cause;
    acted_number_ = verdict->number;
    actions_.add({time_s(), verdict->cause, verdict->joint, action});
    if (action == FindingAction::relearn) {
        feed_forward_.relearn();
    } else if (action == FindingAction::compensate) {
        feed_forward_.compensate(verdict->moved);
    }
}

const ControlLoop::Sent* ControlLoop::command_then(int ago) const noexcept {
    // the command was held until the reading
    const auto before = static_cast<std::size_t>(config_.delay_ticks + ago) + 1;
    return tick_ >= before ? &commands_[(tick_ - before) % commands_.size()] : nullptr;
}

JointVector ControlLoop::disturbance() {
    const JointVector torque = of_regular_joints(feedback_.torque()), rate = feedback_.error_rate();
    observer_.update(torque.data(), feed_forward_.inertia().data(), rate.data(), excess_.data());
    feed_forward_.observer_bandwidth_share(observer_.share());
    return joint_vector(observer_.estimate());
}

JointVector ControlLoop::gradually(const JointVector& wanted) {
    if (!feedback_.regular()) {
        recovery_ = recovery_ticks;
    }
    const JointVector step = (recovery_ > 0 ? recovery_step : feedback_step) * config_.torque_limit;
    JointVector limited = wanted.cwiseMin(feedback_torque_ + step).cwiseMax(feedback_torque_ - step);
    recovery_ -= recovery_ > 0 && limited == wanted ? 1 : 0;
    return limited;
}

bool ControlLoop::limit() {
    const JointVector& most = config_.torque_limit;
    const bool limited = (command_.array().abs() > most.array()).any();
    for (Eigen::Index joint = 0; joint < command_.size(); ++joint) { // a command that is not finite becomes 0
        command_[joint] =
            std::isfinite(command_[joint]) ? std::clamp(command_[joint], -most[joint], most[joint]) : 0;
    }
    return limited;
}

} // namespace dfdyn::tools
