// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/sensors/wrench_sensor.hpp"

#include "tools/simulation/random_streams.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

double bandwidth_of(const WrenchSensorModel& model, double period_s) {
    return model.bandwidth_hz > 0 ? model.bandwidth_hz : 0.25 / period_s;
}

/// Roll, then pitch, then yaw, about fixed axes.
WrenchMatrix response_of(const WrenchSensorModel& model) {
    if (model.rotation.isZero(0)) {
        return model.calibration;
    }
    const Eigen::Matrix3d turn = (Eigen::AngleAxisd(model.rotation.z(), Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(model.rotation.y(), Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(model.rotation.x(), Eigen::Vector3d::UnitX()))
                                     .toRotationMatrix();
    WrenchMatrix turns = WrenchMatrix::Zero();
    turns.topLeftCorner<3, 3>() = turn;
    turns.bottomRightCorner<3, 3>() = turn;
    return model.calibration * turns;
}

} // namespace

WrenchSensor::WrenchSensor(const WrenchSensorModel& model, double period_s, std::uint64_t seed)
    : model_(model), response_(response_of(model)),
      steps_per_reading_(std::llround(1 / (model.rate_hz * period_s))),
      filter_(model.order, bandwidth_of(model, period_s), period_s), delay_steps_(model.delay_s / period_s),
      noise_(seed, stream::wrench_noise) {}

Wrench WrenchSensor::delayed(const Wrench& wrench) {
    if (past_.empty()) { // as if the wrench had always had this value
        past_.assign(static_cast<std::size_t>(delay_steps_) + 2, wrench);
    }
    newest_ = (newest_ + 1) % past_.size();
    past_[newest_] = wrench;
    const auto whole = static_cast<std::size_t>(delay_steps_);
    const double fraction = delay_steps_ - std::floor(delay_steps_);
    const Wrench& later = past_[(newest_ + past_.size() - whole) % past_.size()];
    const Wrench& earlier = past_[(newest_ + past_.size() - whole - 1) % past_.size()];
    return later + fraction * (earlier - later);
}

void WrenchSensor::observe(double time_s, const Wrench& wrench) {
    const Wrench seen = delayed(model_.bandwidth_hz > 0 ? filter_.filter(wrench) : wrench);
    if (next_-- > 0) {
        return;
    }
    next_ = steps_per_reading_ - 1;
    const Wrench size = step();
    const Wrench calibrated = response_ * seen;
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
        const double value = calibrated[axis] + model_.bias[axis] + model_.drift_per_s[axis] * time_s +
                             model_.noise[axis] * noise_.next();
        const double held = std::clamp(value, -model_.range[axis], model_.range[axis] - size[axis]);
        reading_[axis] = size[axis] * std::round(held / size[axis]);
    }
}

Wrench WrenchSensor::step() const { return model_.range * std::exp2(1 - model_.bits); }

} // namespace dfdyn::tools
