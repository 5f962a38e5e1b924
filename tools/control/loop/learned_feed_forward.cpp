// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/learned_feed_forward.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/replay/replay.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace dfdyn::tools {

namespace {

void check_model(const TrainedModel& model, int joints, const std::string& source) {
    const std::vector<std::string> expected =
        output_names(OutputKind::joint_torque, static_cast<std::size_t>(joints));
    if (model.joints != joints || model.outputs.names != expected) {
        throw InputError(source + ": expected a model of the outputs " + listed(expected) +
                         ", found one of " + listed(model.outputs.names));
    }
    if (needs_derivatives(model)) {
        throw InputError(source + ": expected a model of positions alone, found one that needs measured "
                                  "derivatives (input STD)");
    }
}

/// Returns the model with a shorter patience, so that a changed arm is learned quickly. The share of the
/// learned torque is evaluated every second, so learning a contact of half a second has little influence.
TrainedModel impatient(TrainedModel model) {
    constexpr double patience_s = 0.5;
    const int samples = static_cast<int>(std::ceil(patience_s / model.sample_period_s));
    model.limits.innovation_patience = std::min(model.limits.innovation_patience, samples);
    return model;
}

/// Budget of one slice that suffices to learn a sample in `ticks` slices. Each slice may leave up to its
/// largest indivisible step unused.
Budget share_of(const Cost& cost, int ticks) {
    return {(cost.learn + cost.forget + ticks - 1) / ticks + cost.largest_step};
}

} // namespace

LearnedFeedForward::LearnedFeedForward(const TrainedModel& model, bool from_prior, int joints, int ticks,
                                       const std::string& source, const MonitorSetup* monitor,
                                       const ContactModel* contact)
    : sample_period_ns_(std::llround(model.sample_period_s * 1e9)),
      lags_(std::max(model.input.lags, model.physics ? model.physics->motion.lags : 0)) {
    check_model(model, joints, source);
    learner_ = make_estimator(impatient(model), from_prior);
    if (monitor != nullptr) {
        auto watched = monitored(std::move(learner_), *monitor);
        monitor_ = watched.get();
        learner_ = std::move(watched);
    }
    if (contact != nullptr) {
        auto watched = with_contacts(std::move(learner_), *contact);
        contacts_ = watched.get();
        learner_ = std::move(watched);
    }
    follower_ = make_estimator(model, from_prior);
    share_ = share_of(learner_->cost(), ticks);
    weights_.resize(learner_->weight_count());
    learner_->copy_weights(weights_);
    prediction_.resize(static_cast<std::size_t>(joints));
}

void LearnedFeedForward::begin(std::int64_t time_ns, const double* position) {
    begin_ns_ = time_ns;
    learner_->begin_recording();
    follower_->begin_recording();
    for (int lag = lags_; lag >= 0; --lag) {
        follower_->tick({time_ns - lag * sample_period_ns_, of_joints(position), {}, {}, {}});
    }
}

void LearnedFeedForward::learn(std::int64_t time_ns, const double* position, const double* torque) {
    const std::span<const double> output = torque != nullptr ? of_joints(torque) : std::span<const double>();
    const Status status = learner_->tick({time_ns, of_joints(position), {}, {}, output}, share_).status;
    counters_.samples += torque != nullptr ? 1 : 0;
    if (status.learned() || status.learning == Reason::learning_in_progress) {
        ++counters_.learned;
        in_progress_ = true;
        take_over();
    } else if (is_fault(status.reason())) {
        ++counters_.faults;
        counters_.last_fault = status.reason();
    }
}

RecordedChanges LearnedFeedForward::changes() const {
    RecordedChanges recorded{"learned", -1e-9 * static_cast<double>(begin_ns_), {}};
    if (monitor_ != nullptr) {
        recorded.changes = monitor_->changes();
    }
    return recorded;
}

void LearnedFeedForward::go_on() {
    if (in_progress_) {
        learner_->advance(share_);
        take_over();
    }
}

void LearnedFeedForward::take_over() {
    if (learner_->advance(Budget::predict_only())) { // no work is left
        learner_->copy_weights(weights_);
        in_progress_ = false;
    }
}

bool LearnedFeedForward::restore(std::span<const std::byte> snapshot) {
    const bool restored = learner_->restore(snapshot);
    if (restored) {
        in_progress_ = true;
        take_over();
    }
    return restored;
}

std::int64_t LearnedFeedForward::tick_cost() const {
    const Cost cost = learner_->cost();
    return 2 * (cost.predict + cost.variance) + share_.operations;
}

bool LearnedFeedForward::predict(std::int64_t time_ns, const double* reference, double* torque) {
    const Tick tick = follower_->tick({time_ns, of_joints(reference), {}, {}, {}});
    if (!tick.status.estimated()) {
        ++counters_.reference_unknown;
        std::fill_n(torque, prediction_.size(), 0.0);
        return false;
    }
    return take_prediction(torque);
}

bool LearnedFeedForward::rest(const JointVector& position, JointVector& torque) {
    if (rest_lag_ == 0) {
        follower_->begin_recording();
        rest_position_ = position;
    }
    const Tick tick =
        follower_->tick({rest_lag_ * sample_period_ns_, of_joints(rest_position_.data()), {}, {}, {}});
    rest_lag_ = rest_lag_ < lags_ ? rest_lag_ + 1 : 0;
    if (rest_lag_ > 0 || !tick.status.estimated()) {
        return false;
    }
    torque.resize(position.size());
    return take_prediction(torque.data());
}

bool LearnedFeedForward::take_prediction(double* torque) {
    const bool within_bounds = follower_->predict_with(weights_, prediction_);
    std::ranges::copy(prediction_, torque);
    return within_bounds &&
           std::ranges::all_of(prediction_, [](float value) { return std::isfinite(value); });
}

} // namespace dfdyn::tools
