// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/control_loop.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

/// A position with a value that is not finite counts as missing.
bool has_position(const LoopInput& input) { return input.position != nullptr && input.position->allFinite(); }

/// Returns whether the last output of feedback and observer is unreliable because something blocked the arm
/// or a reading was wrong.
bool opposed(StopCause cause, const std::optional<TakenAction>& stop) {
    const bool pushed = cause == StopCause::finding && stop &&
                        (stop->cause == Cause::contact || stop->cause == Cause::frozen);
    return pushed || cause == StopCause::following_error || cause == StopCause::torque_limit ||
           cause == StopCause::frozen_encoder;
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
      missing_(static_cast<std::size_t>(zero_.size())), blind_(missing_.size()) {
    references_.resize(std::size_t{1} + static_cast<std::size_t>(config_.delay_ticks) + SampleClock::max_age);
    references_.front() = task_.next();
    commands_.resize(static_cast<std::size_t>(config_.delay_ticks) + 1);
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
    const LoopState state =
        safe_stop_.tick({feedback_.complete(), input.deadline_missed, input.bus_lost, input.stop_requested,
                         input.returning, joint, feedback_.longest_silence(), watch_.joint()},
                        yields_ ? zero_ : error_);
    if (state == LoopState::running) {
        follow();
    } else if (state != LoopState::waiting && moved()) {
        hold();
        limit();
    }
    return command_;
}

void ControlLoop::sense(const LoopInput& input) {
    clock_.advance();
    feedback_.advance();
    exact_ = false;
    if (has_position(input)) {
        const std::optional<int> place = clock_.place(input.time_ns);
        if (place && *place > 0) {
            early_ = {counters_.ticks + static_cast<std::uint64_t>(*place), *input.position};
        } else if (place) {
            take(-*place, *input.position, input.missing);
        }
    } else if (early_ && early_->tick == counters_.ticks) {
        take(0, early_->position, nullptr);
    }
    if (state() == LoopState::running && !feedback_.complete()) {
        ++counters_.coasted;
    }
}

void ControlLoop::take(int ticks_ago, const JointVector& position, const std::vector<bool>* missing) {
    if (missing != nullptr) {
        missing_ = *missing;
    } else {
        missing_.assign(missing_.size(), false);
    }
    const Reference& reference = measured_reference(ticks_ago);
    watch_.read(position, reference.position, feedback_, missing_);
    for (std::size_t joint = 0; joint < missing_.size(); ++joint) {
        missing_[joint] = missing_[joint] || watch_.repeated()[joint];
    }
    feedback_.observe(ticks_ago, position, reference, &missing_);
    exact_ = ticks_ago == 0 && feedback_.regular();
}

void ControlLoop::follow() {
    if (!moved()) {
        start_ns_ = clock_.expected_ns();
        feed_forward_.begin(start_ns_, reference());
        observer_.restart();
    }
    ++counters_.running;
    const JointVector forward = feed_forward_.update(reference());
    JointVector unlimited;
    if (touched_) {
        command_ = unlimited = slowly(compliant_torque());
    } else {
        const JointVector wanted = feedback_.torque() + disturbance();
        command_ = forward + gradually(wanted);
        unlimited = forward + wanted;
    }
    limit();
    excess_ = unlimited - command_;
    feedback_torque_ = command_ - forward;
    // the command equals the torque of the motion
    const bool full = excess_.isZero(0) && feedback_.regular();
    if (full && !touched_) {
        feed_forward_.commanded(command_);
    }
    const auto period_ns = static_cast<double>(config_.period_s * 1e9);
    feed_forward_.measured(start_ns_ + std::llround(static_cast<double>(tick_) * period_ns),
                           exact_ ? &feedback_.position() : nullptr, command_then());
    commands_[tick_ % commands_.size()] = full ? command_ : JointVector();
    act();
    meet_contact();
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

void ControlLoop::rest_here() {
    const JointVector distance = feedback_.position() - reference().position;
    for (Reference& reference : references_) { // the whole ring: the readings of a delay belong to it, too
        reference.position += distance;
    }
    feedback_.move_reference(distance);
    watch_.move_reference(distance);
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
    const bool again = verdict->number == acted_number_ && verdict->cause == acted_on_;
    if (action == FindingAction::report || again ||
        verdict->confidence < FindingActions::least_confidence(action)) {
        return;
    }
    acted_number_ = verdict->number;
    acted_on_ = verdict->cause;
    actions_.add({time_s(), verdict->cause, verdict->joint, action});
    if (action == FindingAction::relearn) {
        feed_forward_.relearn();
    } else if (action == FindingAction::compensate) {
        feed_forward_.compensate(verdict->moved);
    }
}

const JointVector* ControlLoop::command_then() const noexcept {
    // the command was held until the reading
    const std::size_t ago = static_cast<std::size_t>(config_.delay_ticks) + 1;
    const JointVector* const then = tick_ >= ago ? &commands_[(tick_ - ago) % commands_.size()] : nullptr;
    return then != nullptr && then->size() > 0 ? then : nullptr;
}

JointVector ControlLoop::disturbance() {
    if (feedback_.regular()) {
        const JointVector torque = feedback_.torque(), rate = feedback_.error_rate();
        observer_.update(torque.data(), feed_forward_.inertia().data(), rate.data(), excess_.data());
        feed_forward_.observer_bandwidth_share(observer_.share());
    }
    return joint_vector(observer_.estimate());
}

JointVector ControlLoop::gradually(const JointVector& wanted) {
    if (moved() && !feedback_.regular()) {
        recovery_ = recovery_ticks;
    }
    if (counters_.running == 1) {
        return wanted;
    }
    const JointVector step = (recovery_ > 0 ? recovery_step : feedback_step) * config_.torque_limit;
    JointVector limited = wanted.cwiseMin(feedback_torque_ + step).cwiseMax(feedback_torque_ - step);
    recovery_ -= recovery_ > 0 && limited == wanted ? 1 : 0;
    return limited;
}

void ControlLoop::hold() {
    request_brakes();
    command_ = slowly(limp() ? zero_ : holding_torque());
}

void ControlLoop::begin_braking(Eigen::Index joint) {
    const double age_s = config_.period_s * static_cast<double>(feedback_.age(joint));
    braking_.velocity[joint] = feedback_.velocity()[joint];
    braking_.acceleration[joint] = -braking_.velocity[joint] / stop_time_s;
    braking_.position[joint] = feedback_.position()[joint] + age_s * braking_.velocity[joint];
}

void ControlLoop::brake() {
    if (braking_.position.size() == 0) {
        braking_ = {zero_, zero_, zero_};
        for (Eigen::Index joint = 0; joint < zero_.size(); ++joint) {
            begin_braking(joint);
        }
    }
    for (Eigen::Index joint = 0; joint < zero_.size(); ++joint) {
        const auto j = static_cast<std::size_t>(joint);
        if (blind_[j] && damped(joint)) { // brakes from the present position because readings have returned
            begin_braking(joint);
        }
        blind_[j] = !damped(joint);
        const double before = braking_.velocity[joint];
        const double after = before + config_.period_s * braking_.acceleration[joint];
        if (after * before <= 0) {
            braking_.velocity[joint] = braking_.acceleration[joint] = 0;
        } else {
            braking_.position[joint] += config_.period_s * (before + after) / 2;
            braking_.velocity[joint] = after;
        }
    }
}

JointVector ControlLoop::holding_torque() {
    brake();
    Reference where = braking_; // reference at the measured position
    for (Eigen::Index joint = 0; joint < zero_.size(); ++joint) {
        where.position[joint] = damped(joint) ? feedback_.position()[joint] : where.position[joint];
    }
    JointVector torque = feed_forward_.holding(where);
    if (!opposed(safe_stop_.cause(), actions_.stop())) {
        torque += joint_vector(observer_.lasting());
    }
    for (Eigen::Index joint = 0; joint < torque.size(); ++joint) {
        if (damped(joint)) {
            const double most = spring_share * config_.torque_limit[joint];
            const double spring = std::max(0.0, config_.gains.position[joint]) *
                                  (braking_.position[joint] - feedback_.position()[joint]);
            torque[joint] += std::clamp(spring, -most, most);
            torque[joint] += std::max(0.0, config_.gains.velocity[joint]) *
                             (braking_.velocity[joint] - feedback_.velocity()[joint]);
        }
    }
    return torque;
}

void ControlLoop::request_brakes() {
    constexpr double rest_speed = 0.05; // rad/s, m/s
    if (brake_tick_) {
        return;
    }
    bool blind = false, rests = true;
    for (Eigen::Index joint = 0; joint < zero_.size(); ++joint) {
        blind = blind || !damped(joint);
        rests = rests && damped(joint) && std::abs(feedback_.velocity()[joint]) <= rest_speed;
    }
    const bool stopped = state() == LoopState::stopped;
    stopped_tick_ = stopped && !stopped_tick_ ? counters_.ticks : stopped_tick_;
    const double waited_s =
        stopped ? config_.period_s * static_cast<double>(counters_.ticks - *stopped_tick_) : 0;
    if (blind || (stopped && (rests || waited_s >= brake_timeout_s))) {
        brake_tick_ = counters_.ticks;
    }
}

bool ControlLoop::limp() const noexcept {
    return config_.safe_stop.mode == StopMode::limp && state() == LoopState::stopped && brake_tick_ &&
           counters_.ticks - *brake_tick_ >= static_cast<std::uint64_t>(config_.safe_stop.brake_ticks);
}

bool ControlLoop::done() const noexcept {
    const double silent_s = config_.period_s * static_cast<double>(counters_.ticks - position_tick_);
    const bool over = told_ || limp() || silent_s >= give_up_s;
    return state() == LoopState::stopped && (!moved() || (brake_requested() && over));
}

void ControlLoop::limit() {
    const JointVector& most = config_.torque_limit;
    counters_.limited += (command_.array().abs() > most.array()).any() ? 1 : 0;
    for (Eigen::Index joint = 0; joint < command_.size(); ++joint) { // a command that is not finite becomes 0
        command_[joint] =
            std::isfinite(command_[joint]) ? std::clamp(command_[joint], -most[joint], most[joint]) : 0;
    }
}

} // namespace dfdyn::tools
