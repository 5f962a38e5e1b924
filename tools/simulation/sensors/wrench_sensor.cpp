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
      filter_(model.order, bandwidth_of(model, period_s), period_s),
      delay_(Wrench::Constant(model.delay_s / period_s)), noise_(seed, stream::wrench_noise) {}

void WrenchSensor::observe(double time_s, const Wrench& wrench) {
    delay_.push(model_.bandwidth_hz > 0 ? filter_.filter(wrench) : wrench);
    if (next_-- > 0) {
        return;
    }
    next_ = steps_per_reading_ - 1;
    const Wrench size = step();
    const Wrench calibrated = response_ * delay_.delayed();
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
        const double value = calibrated[axis] + model_.bias[axis] + model_.drift_per_s[axis] * time_s +
                             model_.noise[axis] * noise_.next();
        const double held = std::clamp(value, -model_.range[axis], model_.range[axis] - size[axis]);
        reading_[axis] = size[axis] * std::round(held / size[axis]);
    }
}

Wrench WrenchSensor::step() const { return model_.range * std::exp2(1 - model_.bits); }

} // namespace dfdyn::tools
