// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/learned_feed_forward.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/model/structure.hpp"
#include "tools/replay/replay.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace dfdyn::tools {

namespace {

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
                                       const ContactSetup* contact)
    : sample_period_ns_(std::llround(model.sample_period_s * 1e9)),
      lags_(std::max(model.input.lags, model.physics ? model.physics->motion.lags : 0)) {
    check_loop_model(model, joints, source);
    auto estimator = make_estimator(impatient(model), from_prior);
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
    learners_.emplace_back(std::move(estimator), make_estimator(model, from_prior), ticks);
    if (structure_of(model).coupled()) {
        for (const double memory_s : physics_memories_s) {
            const TrainedModel physics = physics_of(model, memory_s);
            learners_.emplace_back(make_estimator(physics, true), make_estimator(physics, true), ticks);
        }
    }
    prediction_.resize(static_cast<std::size_t>(joints));
    forecasts_at_rest_.resize(static_cast<std::size_t>(forecast_count()) * prediction_.size());
}

LearnedFeedForward::Learner::Learner(std::unique_ptr<RuntimeEstimator> learning,
                                     std::unique_ptr<RuntimeEstimator> following, int ticks)
    : estimator(std::move(learning)), follower(std::move(following)),
      share(share_of(estimator->cost(), ticks)), weights(follower->weight_count()) {
    take_over();
}

void LearnedFeedForward::begin(std::int64_t time_ns, const double* position) {
    begin_ns_ = time_ns;
    for (Learner& learner : learners_) {
        learner.estimator->begin_recording();
        learner.follower->begin_recording();
    }
    for (int lag = lags_; lag >= 0; --lag) {
        follow(time_ns - lag * sample_period_ns_, position);
    }
}

void LearnedFeedForward::learn(std::int64_t time_ns, const double* position, const double* torque) {
    const std::span<const double> output = torque != nullptr ? of_joints(torque) : std::span<const double>();
    const MeasuredSample sample{time_ns, of_joints(position), {}, {}, output};
    const Status status = learners_.front().learn(sample, may_learn_);
    const bool touched = contact_joint() >= 0;
    for (Learner& physics : std::span(learners_).subspan(1)) { // does not learn a contact, either
        physics.learn(sample, may_learn_ && !touched);
    }
    counters_.samples += torque != nullptr && may_learn_ ? 1 : 0;
    if (learns(status)) {
        ++counters_.learned;
    } else if (may_learn_ && is_fault(status.reason())) {
        ++counters_.faults;
        counters_.last_fault = status.reason();
    }
}

RecordedChanges LearnedFeedForward::changes(const std::string& run) const {
    RecordedChanges recorded{run, -1e-9 * static_cast<double>(begin_ns_), {}};
    if (monitor_ != nullptr) {
        recorded.changes = monitor_->changes();
    }
    return recorded;
}

void LearnedFeedForward::go_on() {
    for (Learner& learner : learners_) {
        learner.go_on();
    }
}

Status LearnedFeedForward::Learner::learn(const MeasuredSample& sample, bool may_learn) {
    const Status status = estimator->tick(sample, may_learn ? share : Budget::predict_only()).status;
    if (!may_learn) {
        go_on(); // the sample before
    } else if (learns(status)) {
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
        estimator->copy_weights(weights);
        in_progress = false;
    }
}

bool LearnedFeedForward::restore(std::span<const std::byte> snapshot) {
    Learner& learner = learners_.front();
    const bool restored = learner.estimator->restore(snapshot);
    if (restored) {
        learner.in_progress = true;
        learner.take_over();
    }
    return restored;
}

std::int64_t LearnedFeedForward::tick_cost() const {
    std::int64_t total = 0;
    for (const Learner& learner : learners_) {
        const Cost cost = learner.estimator->cost();
        // the estimator's tick, and the follower's with a prediction from the learned weights
        total += 2 * (cost.predict + cost.variance) + learner.share.operations + cost.predict;
    }
    return total;
}

void LearnedFeedForward::follow(std::int64_t time_ns, const double* reference) {
    for (Learner& learner : learners_) {
        const Tick tick = learner.follower->tick({time_ns, of_joints(reference), {}, {}, {}});
        learner.follows = tick.status.estimated();
    }
}

bool LearnedFeedForward::predict(std::int64_t time_ns, const double* reference, double* torque) {
    follow(time_ns, reference);
    const bool known = take_forecasts(torque);
    counters_.reference_unknown += known ? 0 : 1;
    return known;
}

bool LearnedFeedForward::take_forecasts(double* torque) {
    bool known = false;
    for (const Learner& learner : learners_) {
        known = take_prediction(learner, torque) || known;
        torque += prediction_.size();
    }
    return known;
}

std::span<const double> LearnedFeedForward::rest(const JointVector& position) {
    if (rest_lag_ == 0) {
        for (Learner& learner : learners_) {
            learner.follower->begin_recording();
        }
        rest_position_ = position;
    }
    follow(rest_lag_ * sample_period_ns_, rest_position_.data());
    rest_lag_ = rest_lag_ < lags_ ? rest_lag_ + 1 : 0;
    if (rest_lag_ > 0 || !take_forecasts(forecasts_at_rest_.data())) {
        return {};
    }
    return forecasts_at_rest_;
}

bool LearnedFeedForward::take_prediction(const Learner& learner, double* torque) {
    const bool known = learner.follows && learner.follower->predict_with(learner.weights, prediction_) &&
                       std::ranges::all_of(prediction_, [](float value) { return std::isfinite(value); });
    std::ranges::transform(prediction_, torque,
                           [=](float value) { return known ? static_cast<double>(value) : unknown_torque; });
    return known;
}

} // namespace dfdyn::tools
