// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/sensors/torque_sensor.hpp"

#include "tools/simulation/random_streams.hpp"

namespace dfdyn::tools {

TorqueSensor::TorqueSensor(const TorqueSensorModel& model, double period_s, std::uint64_t seed)
    : model_(model), noise_(seed, stream::torque_noise) {
    if (model.delay_s) {
        delay_.emplace(JointVector(*model.delay_s / period_s));
    }
}

void TorqueSensor::observe(const JointVector& torque) {
    if (delay_) {
        delay_->push(torque);
    }
}

JointVector TorqueSensor::read(const JointVector& torque) {
    JointVector reading = delay_ ? delay_->delayed() : torque;
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
