// SPDX-License-Identifier: Apache-2.0
#include "tools/control/learned_feed_forward.hpp"

#include "tools/common/error.hpp"
#include "tools/common/text.hpp"
#include "tools/evaluation/replay.hpp"

#include <algorithm>
#include <cmath>

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

std::span<const double> values(const JointVector& vector) {
    return {vector.data(), static_cast<std::size_t>(vector.size())};
}

} // namespace

LearnedFeedForward::LearnedFeedForward(const TrainedModel& model, bool from_prior, int joints,
                                       const std::string& source)
    : sample_period_s_(model.sample_period_s),
      lags_(std::max(model.input.lags, model.physics ? model.physics->motion.lags : 0)) {
    check_model(model, joints, source);
    learner_ = make_estimator(model, from_prior);
    follower_ = make_estimator(model, from_prior);
    weights_.resize(learner_->weight_count());
    learner_->copy_weights(weights_);
    prediction_.resize(static_cast<std::size_t>(joints));
}

void LearnedFeedForward::begin(std::int64_t time_ns, const JointVector& position) {
    learner_->begin_recording();
    follower_->begin_recording();
    const auto period_ns = static_cast<std::int64_t>(std::llround(sample_period_s_ * 1e9));
    for (int lag = lags_; lag >= 0; --lag) {
        follower_->tick({time_ns - lag * period_ns, values(position), {}, {}, {}});
    }
}

void LearnedFeedForward::learn(std::int64_t time_ns, const JointVector& position, const JointVector& torque) {
    const Status status = learner_->tick({time_ns, values(position), {}, {}, values(torque)}).status;
    ++counters_.samples;
    if (status.learned()) {
        ++counters_.learned;
        learner_->copy_weights(weights_);
    } else if (is_fault(status.reason())) {
        ++counters_.faults;
        counters_.last_fault = status.reason();
    }
}

bool LearnedFeedForward::predict(std::int64_t time_ns, const JointVector& reference, JointVector& torque) {
    const Tick tick = follower_->tick({time_ns, values(reference), {}, {}, {}});
    if (!tick.status.predicted()) {
        ++counters_.reference_unknown;
        return false;
    }
    follower_->predict_with(weights_, prediction_);
    torque = Eigen::Map<const Eigen::VectorXf>(prediction_.data(), reference.size()).cast<double>();
    return torque.allFinite();
}

} // namespace dfdyn::tools
