// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/horizon_error.hpp"

#include <limits>
#include <utility>

namespace dfdyn::tools {

HorizonError::HorizonError(std::size_t horizon, std::size_t outputs, std::size_t weights)
    : horizon_(horizon), outputs_(outputs), weight_count_(weights), prediction_(outputs) {}

void HorizonError::add(const RuntimeEstimator& estimator, std::span<const double> measured) {
    for (Model& model : models_) {
        add_to(model, estimator, measured);
    }
    if (models_.size() == horizon_) {
        finish_oldest();
    }
    Model present{std::vector<float>(weight_count_), ticks_, std::vector<double>(outputs_),
                  std::vector<double>(outputs_)};
    estimator.copy_weights(present.weights);
    models_.push_back(std::move(present));
    ++ticks_;
}

void HorizonError::skip() {
    interrupt();
    ++ticks_;
}

void HorizonError::interrupt() { models_.clear(); }

void HorizonError::forget_before(std::size_t tick) {
    std::erase_if(indices_, [tick](const HorizonIndex& index) { return index.tick < tick; });
}

void HorizonError::add_to(Model& model, const RuntimeEstimator& estimator, std::span<const double> measured) {
    estimator.predict_with(model.weights, prediction_);
    for (std::size_t k = 0; k < outputs_; ++k) {
        const double error = measured[k] - static_cast<double>(prediction_[k]);
        model.error_square[k] += error * error;
        model.output_square[k] += measured[k] * measured[k];
    }
}

void HorizonError::finish_oldest() {
    const Model& oldest = models_.front();
    HorizonIndex index{oldest.tick, std::vector<double>(outputs_), oldest.error_square};
    for (std::size_t k = 0; k < outputs_; ++k) {
        index.epsilon[k] = oldest.output_square[k] > 0 ? oldest.error_square[k] / oldest.output_square[k]
                                                       : std::numeric_limits<double>::infinity();
    }
    indices_.push_back(std::move(index));
    models_.pop_front();
}

} // namespace dfdyn::tools
