// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/simulated_plant.hpp"

#include "tools/common/error.hpp"
#include "tools/common/number.hpp"
#include "tools/simulation/random_streams.hpp"

#include <cmath>

namespace dfdyn::tools {

namespace {

std::vector<bool> prismatic(const Robot& robot) {
    std::vector<bool> result;
    for (const RobotJoint& joint : robot.joints) {
        result.push_back(joint.prismatic);
    }
    return result;
}

} // namespace

SimulatedPlant::SimulatedPlant(const Robot& robot, const Scenario& scenario, const JointVector& position)
    : torque_noise_deviation_(scenario.torque_sensor.noise), period_s_(1 / scenario.integration_rate_hz),
      encoder_steps_(std::llround(scenario.integration_rate_hz / scenario.encoders.rate_hz)),
      arm_(robot, scenario.actuators, position), payloads_(scenario.payloads, robot),
      encoders_(scenario.encoders, prismatic(robot), scenario.seed),
      torque_noise_(scenario.seed, stream::torque_noise) {
    if (scenario.force_torque) {
        wrench_sensor_.emplace(*scenario.force_torque, period_s_, scenario.seed);
    }
    observe();
}

void SimulatedPlant::observe() {
    payloads_.attach_due(time_s(), arm_);
    if (step_ % encoder_steps_ == 0) {
        encoders_.observe(arm_.state().position);
    }
    if (wrench_sensor_) {
        wrench_sensor_->observe(time_s(), arm_.wrench());
    }
}

void SimulatedPlant::advance_to(double time_s) {
    const std::int64_t last = std::llround(time_s / period_s_);
    while (step_ < last) {
        arm_.advance(period_s_);
        ++step_;
        observe();
    }
    constexpr double runaway = 1e4; // rad/s
    if (!arm_.state().position.allFinite() || arm_.state().velocity.cwiseAbs().maxCoeff() > runaway) {
        throw InputError("t = " + number_text(time_s) +
                         " s: expected the arm to stay under control, found it running away: gains, friction "
                         "or integration_rate_hz do not fit");
    }
}

JointVector SimulatedPlant::torque() {
    JointVector reading = arm_.state().torque;
    for (Eigen::Index i = 0; i < reading.size(); ++i) {
        reading[i] += torque_noise_deviation_[i] * torque_noise_.next();
    }
    return reading;
}

} // namespace dfdyn::tools
