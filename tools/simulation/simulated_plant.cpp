// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/simulated_plant.hpp"

#include "tools/simulation/arm/joint_limits.hpp"

#include <cmath>

namespace dfdyn::tools {

SimulatedPlant::SimulatedPlant(const Robot& robot, const Scenario& scenario, const JointVector& first)
    : period_s_(1 / scenario.integration_rate_hz),
      encoder_steps_(std::llround(scenario.integration_rate_hz / scenario.encoders.rate_hz)),
      arm_(real_robot(robot, scenario.robot_errors), scenario.actuators, start_position(scenario, first),
           scenario.loads),
      payloads_(scenario.payloads, robot), faults_(scenario.faults, robot.joints.size()),
      encoders_(scenario.encoders, prismatic_joints(robot), scenario.seed),
      torque_sensor_(scenario.torque_sensor, period_s_, scenario.seed) {
    if (scenario.force_torque) {
        wrench_sensor_.emplace(*scenario.force_torque, period_s_, scenario.seed);
    }
    observe();
}

void SimulatedPlant::observe() {
    payloads_.update(time_s(), arm_);
    if (faults_.go_to(time_s())) {
        arm_.set_faults(faults_.now().arm);
        encoders_.set_faults(faults_.now().encoders);
        torque_sensor_.set_faults(faults_.now().torque_sensor);
    }
    if (step_ % encoder_steps_ == 0) {
        encoders_.observe(arm_.state().motor_position);
    }
    torque_sensor_.observe(arm_.state().torque);
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
    check_stable(arm_.state().position, arm_.state().velocity, time_s);
}

} // namespace dfdyn::tools
