// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/simulation.hpp"

#include "tools/base/text/number.hpp"
#include "tools/simulation/arm/joint_limits.hpp"
#include "tools/simulation/random_streams.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

std::optional<WrenchSensor> wrench_sensor(const Scenario& scenario) {
    if (!scenario.force_torque) {
        return std::nullopt;
    }
    return WrenchSensor(*scenario.force_torque, 1 / scenario.integration_rate_hz, scenario.seed);
}

} // namespace

Simulation::Simulation(const Robot& robot, const Scenario& scenario)
    : robot_(robot), scenario_(scenario), period_s_(1 / scenario.integration_rate_hz),
      encoder_steps_(std::llround(scenario.integration_rate_hz / scenario.encoders.rate_hz)),
      derivative_steps_(std::llround(scenario.integration_rate_hz / scenario.derivatives.rate_hz)),
      control_steps_(std::llround(scenario.integration_rate_hz / scenario.controller.rate_hz)),
      task_(make_task(scenario.task, robot, 1 / scenario.controller.rate_hz, scenario.seed)),
      reference_(task_->next()), arm_(real_robot(robot, scenario.robot_errors), scenario.actuators,
                                      start_position(scenario, reference_.position), scenario.loads),
      payloads_(scenario.payloads, robot), faults_(scenario.faults, robot.joints.size()),
      controller_(robot, scenario.actuators.rotor_inertia, scenario.controller, scenario.seed),
      encoders_(scenario.encoders, prismatic_joints(robot), scenario.seed),
      control_derivatives_(scenario.derivatives, static_cast<int>(robot.joints.size()),
                           1 / scenario.encoders.rate_hz),
      derivatives_(scenario.derivatives, static_cast<int>(robot.joints.size()),
                   1 / scenario.derivatives.rate_hz),
      wrench_sensor_(wrench_sensor(scenario)),
      torque_sensor_(scenario.torque_sensor, period_s_, scenario.seed),
      jitter_(scenario.seed, stream::clock_jitter) {
    if (scenario.output_noise) {
        output_noise_.emplace(*scenario.output_noise, scenario.seed);
    }
    observe();
}

void Simulation::control() {
    const double time_s = static_cast<double>(step_) * period_s_;
    check_limits(robot_, reference_.position, "t = " + number_text(time_s) + " s: reference of ");
    check_stable(arm_.state().position, arm_.state().velocity, time_s);
    arm_.apply(controller_.torque(reference_, encoders_.reading(), control_derivatives_.velocity()));
    reference_ = task_->next();
}

/// Updates payloads and sensors for the current state.
void Simulation::observe() {
    const double time_s = static_cast<double>(step_) * period_s_;
    payloads_.update(time_s, arm_);
    if (faults_.go_to(time_s)) {
        arm_.set_faults(faults_.now().arm);
        encoders_.set_faults(faults_.now().encoders);
        torque_sensor_.set_faults(faults_.now().torque_sensor);
    }
    if (step_ % encoder_steps_ == 0) {
        encoders_.observe(arm_.state().motor_position);
        control_derivatives_.observe(encoders_.reading());
    }
    if (step_ % derivative_steps_ == 0) {
        derivatives_.observe(encoders_.reading());
    }
    if (step_ % control_steps_ == 0) {
        control();
    }
    torque_sensor_.observe(arm_.state().torque);
    if (wrench_sensor_) {
        wrench_sensor_->observe(time_s, arm_.wrench());
    }
}

double Simulation::jitter(double deviation_s) { return deviation_s * std::clamp(jitter_.next(), -4.0, 4.0); }

SimulatedSample Simulation::next() {
    const RecordingModel& recording = scenario_.recording;
    const double instant_s = recording.first_at_s + static_cast<double>(taken_++) / recording.rate_hz +
                             jitter(recording.instant_jitter_s);
    // jitter and rounding to whole steps could give two rows one instant
    const std::int64_t earliest = taken_ > 1 ? step_ + 1 : step_;
    const std::int64_t instant =
        std::max<std::int64_t>(earliest, std::llround(instant_s * scenario_.integration_rate_hz));
    while (step_ < instant) {
        arm_.advance(period_s_);
        ++step_;
        observe();
    }
    SimulatedSample sample = take();
    sample.time_s += jitter(recording.stamp_jitter_s);
    return sample;
}

SimulatedSample Simulation::take() {
    const SimulatedArm::State& state = arm_.state();
    SimulatedSample sample;
    sample.truth.time_s = static_cast<double>(step_) * period_s_;
    sample.truth.position = state.position;
    sample.truth.velocity = state.velocity;
    sample.truth.acceleration = state.acceleration;
    sample.truth.torque = state.torque;
    sample.truth.friction = state.friction;
    sample.truth.motor_position = state.motor_position;
    sample.truth.motor_velocity = state.motor_velocity;
    sample.truth.motor_acceleration = state.motor_acceleration;
    sample.truth.tip = arm_.dynamics().tip(arm_.configuration());
    sample.time_s = sample.truth.time_s;
    sample.position = encoders_.reading();
    sample.velocity = derivatives_.velocity();
    sample.acceleration = derivatives_.acceleration();
    sample.torque = torque_sensor_.read(state.torque);
    if (wrench_sensor_) {
        sample.wrench = wrench_sensor_->reading();
        sample.truth.wrench = arm_.wrench();
    }
    if (output_noise_) {
        sample.torque += output_noise_->torque();
        sample.wrench += output_noise_->wrench();
    }
    return sample;
}

} // namespace dfdyn::tools
