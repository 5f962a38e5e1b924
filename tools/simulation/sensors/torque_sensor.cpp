// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/sensors/torque_sensor.hpp"

#include "tools/simulation/random_streams.hpp"

#include <cmath>

namespace dfdyn::tools {

TorqueSensor::TorqueSensor(const TorqueSensorModel& model, double period_s, std::uint64_t seed)
    : model_(model), noise_(seed, stream::torque_noise) {
    if (model.delay_s) {
        delay_steps_ = *model.delay_s / period_s;
    }
}

void TorqueSensor::observe(const JointVector& torque) {
    if (!model_.delay_s) {
        return;
    }
    if (past_.empty()) { // as if the torque had always had this value
        past_.assign(static_cast<std::size_t>(delay_steps_.maxCoeff()) + 2, torque);
    }
    newest_ = (newest_ + 1) % past_.size();
    past_[newest_] = torque;
}

JointVector TorqueSensor::delayed() const {
    JointVector result(delay_steps_.size());
    for (Eigen::Index i = 0; i < result.size(); ++i) {
        const auto whole = static_cast<std::size_t>(delay_steps_[i]);
        const double fraction = delay_steps_[i] - std::floor(delay_steps_[i]);
        const double later = past_[(newest_ + past_.size() - whole) % past_.size()][i];
        const double earlier = past_[(newest_ + past_.size() - whole - 1) % past_.size()][i];
        result[i] = later + fraction * (earlier - later);
    }
    return result;
}

JointVector TorqueSensor::read(const JointVector& torque) {
    JointVector reading = model_.delay_s ? delayed() : torque;
    if (model_.gain) {
        reading = reading.cwiseQuotient(*model_.gain);
    }
    if (model_.offset) {
        reading += *model_.offset;
    }
    for (Eigen::Index i = 0; i < reading.size(); ++i) {
        reading[i] += model_.noise[i] * noise_.next();
    }
    if (faults_) {
        reading = reading.cwiseProduct(faults_->factor) + faults_->bias;
    }
    return reading;
}

} // namespace dfdyn::tools
