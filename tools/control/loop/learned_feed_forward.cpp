// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/learned_feed_forward.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/model/structure.hpp"
#include "tools/replay/replay.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace dfdyn::tools {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Returns the model with a shorter patience, so that a changed arm is learned quickly. The share of the
/// learned torque is evaluated every second, so learning a contact of half a second has little influence.
TrainedModel impatient(TrainedModel model) {
    constexpr double patience_s = 0.5;
    const int samples = static_cast<int>(std::ceil(patience_s / model.sample_period_s));
    model.limits.innovation_patience = std::min(model.limits.innovation_patience, samples);
    return model;
}

/// Returns model P of the physics of a model with features. The features' part of the outputs counts as noise
/// with their prior variance. The memory has at least one sample per parameter. Every sample is learned.
TrainedModel physics_of(TrainedModel model, double memory_s) {
    const double noise_factor = std::sqrt(1 + model.outputs.prior_variance);
    for (double& noise : model.outputs.noise_std) {
        noise *= noise_factor;
    }
    const auto parameters = static_cast<double>(model.physics->selected.size());
    model.structure = structures::P.name;
    model.features = {};
    model.extrapolation.reset();
    model.forgetting_factor = std::max(1 - model.sample_period_s / memory_s, 1 - 1 / parameters);
    model.limits.innovation_patience = 0;
    return model;
}

/// Budget of one slice that suffices to learn a sample in `ticks` slices. Each slice may leave up to its
/// largest indivisible step unused.
Budget share_of(const Cost& cost, int ticks) {
    return {(cost.learn + cost.forget + ticks - 1) / ticks + cost.largest_step};
}

bool learns(const Status& status) {
    return status.learned() || status.learning == Reason::learning_in_progress;
}

} // namespace

void check_loop_model(const TrainedModel& model, int joints, const std::string& source) {
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

LearnedFeedForward::LearnedFeedForward(const TrainedModel& model, bool from_prior, int joints, int ticks,
                                       const std::string& source, const MonitorSetup* monitor,
                                       const ContactModel* contact)
    : sample_period_ns_(std::llround(model.sample_period_s * 1e9)),
      lags_(std::max(model.input.lags, model.physics ? model.physics->motion.lags : 0)) {
    check_loop_model(model, joints, source);
    std::unique_ptr<RuntimeEstimator>& estimator = learner_.estimator;
    estimator = make_estimator(impatient(model), from_prior);
    if (monitor != nullptr) {
        auto watched = monitored(std::move(estimator), *monitor);
        monitor_ = watched.get();
        estimator = std::move(watched);
    }
    if (contact != nullptr) {
        auto watched = with_contacts(std::move(estimator), *contact);
        contacts_ = watched.get();
        estimator = std::move(watched);
    }
    follower_ = make_estimator(model, from_prior);
    if (structure_of(model).coupled()) {
        for (const double memory_s : physics_memories_s) {
            physics_.push_back({.estimator = make_estimator(physics_of(model, memory_s), true)});
        }
    }
    const auto prepare = [&](Learner& one) {
        one.share = share_of(one.estimator->cost(), ticks);
        one.weights.resize(follower_->weight_count());
        one.take_over();
    };
    prepare(learner_);
    for (Learner& physics : physics_) {
        prepare(physics);
    }
    prediction_.resize(static_cast<std::size_t>(joints));
    forecasts_at_rest_.resize(static_cast<std::size_t>(forecast_count()) * prediction_.size());
}

void LearnedFeedForward::begin(std::int64_t time_ns, const double* position) {
    begin_ns_ = time_ns;
    learner_.estimator->begin_recording();
    for (Learner& physics : physics_) {
        physics.estimator->begin_recording();
    }
    follower_->begin_recording();
    for (int lag = lags_; lag >= 0; --lag) {
        follower_->tick({time_ns - lag * sample_period_ns_, of_joints(position), {}, {}, {}});
    }
}

void LearnedFeedForward::learn(std::int64_t time_ns, const double* position, const double* torque) {
    const std::span<const double> output = torque != nullptr ? of_joints(torque) : std::span<const double>();
    const MeasuredSample sample{time_ns, of_joints(position), {}, {}, output};
    const Status status = learner_.learn(sample);
    const bool touched = contact_joint() >= 0;
    for (Learner& physics : physics_) { // does not learn a contact, either
        physics.learn(touched ? MeasuredSample{time_ns, of_joints(position), {}, {}, {}} : sample);
    }
    counters_.samples += torque != nullptr ? 1 : 0;
    if (learns(status)) {
        ++counters_.learned;
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
    learner_.go_on();
    for (Learner& physics : physics_) {
        physics.go_on();
    }
}

Status LearnedFeedForward::Learner::learn(const MeasuredSample& sample) {
    const Status status = estimator->tick(sample, share).status;
    if (learns(status)) {
        in_progress = true;
        take_over();
    }
    return status;
}

void LearnedFeedForward::Learner::go_on() {
    if (in_progress) {
        estimator->advance(share);
        take_over();
    }
}

void LearnedFeedForward::Learner::take_over() {
    if (estimator->advance(Budget::predict_only())) { // no work is left
        // the physics' parameters are the last ones of any model's weights
        estimator->copy_weights(std::span(weights).last(estimator->weight_count()));
        in_progress = false;
    }
}

bool LearnedFeedForward::restore(std::span<const std::byte> snapshot) {
    const bool restored = learner_.estimator->restore(snapshot);
    if (restored) {
        learner_.in_progress = true;
        learner_.take_over();
    }
    return restored;
}

std::int64_t LearnedFeedForward::tick_cost() const {
    const Cost cost = learner_.estimator->cost();
    // the learner's tick, and the follower's with a prediction from the learner's weights
    std::int64_t total = 2 * (cost.predict + cost.variance) + learner_.share.operations + cost.predict;
    for (const Learner& physics : physics_) { // its own tick, and another prediction for the reference
        const Cost of_physics = physics.estimator->cost();
        total += of_physics.predict + of_physics.variance + physics.share.operations + cost.predict;
    }
    return total;
}

bool LearnedFeedForward::predict(std::int64_t time_ns, const double* reference, double* torque) {
    const Tick tick = follower_->tick({time_ns, of_joints(reference), {}, {}, {}});
    if (!tick.status.estimated()) {
        ++counters_.reference_unknown;
        std::fill_n(torque, static_cast<std::size_t>(forecast_count()) * prediction_.size(), unknown);
        return false;
    }
    return take_forecasts(torque);
}

bool LearnedFeedForward::take_forecasts(double* torque) {
    bool known = take_prediction(learner_, torque);
    for (const Learner& physics : physics_) {
        torque += prediction_.size();
        known = take_prediction(physics, torque) || known;
    }
    return known;
}

std::span<const double> LearnedFeedForward::rest(const JointVector& position) {
    if (rest_lag_ == 0) {
        follower_->begin_recording();
        rest_position_ = position;
    }
    const Tick tick =
        follower_->tick({rest_lag_ * sample_period_ns_, of_joints(rest_position_.data()), {}, {}, {}});
    rest_lag_ = rest_lag_ < lags_ ? rest_lag_ + 1 : 0;
    if (rest_lag_ > 0 || !tick.status.estimated() || !take_forecasts(forecasts_at_rest_.data())) {
        return {};
    }
    return forecasts_at_rest_;
}

bool LearnedFeedForward::take_prediction(const Learner& learner, double* torque) {
    const bool known = follower_->predict_with(learner.weights, prediction_) &&
                       std::ranges::all_of(prediction_, [](float value) { return std::isfinite(value); });
    std::ranges::transform(prediction_, torque,
                           [=](float value) { return known ? static_cast<double>(value) : unknown; });
    return known;
}

} // namespace dfdyn::tools
