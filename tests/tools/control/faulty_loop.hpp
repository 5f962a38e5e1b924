// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/tools/control/pendulum.hpp"
#include "tools/can/arm/device_frames.hpp"
#include "tools/can/arm/torque_frames.hpp"
#include "tools/control/bus/loop_port.hpp"
#include "tools/control/bus/memory_bus.hpp"
#include "tools/control/loop_setup.hpp"
#include "tools/simulation/simulated_plant.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>

namespace dfdyn::tests {

/// Fault of a loop and its arm at one tick of the motion.
struct LoopFault {
    using Drops = std::function<bool(const hal::Frame&)>;
    using Reads = std::function<void(tools::JointVector&)>;

    bool lost = false;         ///< no frame that the devices send in this tick arrives
    std::int64_t clock_ns = 0; ///< added to the stamps of the frames that arrive
    int late_ticks = 0;        ///< if not 0, the loop does not run in this tick and makes up for it later
    tools::LoopInput given{};  ///< only deadline_missed, bus_lost and stop_requested are used
    Drops drops{};             ///< returns true for device frames that do not arrive
    Reads reads{};             ///< changes the positions that the encoders report
};

/// A loop and the simulated arm of a scenario, connected by the frames of the arm's devices. It runs tick by
/// tick in simulated time, with faults.
class FaultyLoop {
  public:
    using Faults = std::function<LoopFault(int tick)>;

    FaultyLoop(const tools::Robot& robot, const tools::Scenario& scenario, const tools::BusDescription& bus,
               const tools::LoopModel* learned = nullptr, const tools::LoopLimits& limits = {})
        : period_s_(1 / scenario.controller.rate_hz), port_(bus, period_s_), devices_(bus), torques_(bus),
          has_sensor_(bus.sensor.has_value()),
          loop_(tools::make_control_loop(robot, scenario, "test", learned, port_.delay_ticks(), limits)),
          limit_(*scenario.actuators.torque_limit), plant_(robot, scenario, loop_->reference().position),
          command_(tools::JointVector::Zero(limit_.size())), drive_(command_) {
        tools::MemoryBus::join(loop_end_, wire_);
    }

    /// Runs until `time_s` since the motion began, also after the loop has stopped.
    void run_to(
        double time_s, const Faults& faults = [](int) { return LoopFault{}; }) {
        while (moving_tick_ * period_s_ < time_s) {
            step(faults);
        }
    }

    void forget_peaks() {
        peak_step_ = peak_speed_ = 0;
        start_ = plant_.truth().position;
        peak_distance_ = 0;
    }
    /// Largest change of a command in one tick, as a share of the torque limit.
    double peak_step() const { return peak_step_; }
    double peak_speed() const { return peak_speed_; } ///< largest speed of a joint, rad/s
    double peak_distance() const {
        return peak_distance_;
    } ///< largest distance of a joint from its position at the last `forget_peaks`, rad
    int moving_tick() const { return moving_tick_; }
    int delay_ticks() const { return port_.delay_ticks(); }
    const tools::ControlLoop& loop() const { return *loop_; }
    tools::SimulatedPlant& plant() { return plant_; }
    const tools::JointVector& command() const { return command_; }
    /// Whether the arm's brakes have closed, which is 0.2 s after the request. From then on nothing moves.
    bool braked() const { return braked_tick_ >= 0 && moving_tick_ >= braked_tick_; }
    const tools::PortCounters& port() const { return port_.counters(); }

  private:
    static std::span<const double> values(const tools::JointVector& vector) {
        return {vector.data(), static_cast<std::size_t>(vector.size())};
    }

    void step(const Faults& faults) {
        const LoopFault fault = faults(moving_tick_);
        now_ns_ = std::llround(static_cast<double>(tick_++) * period_s_ * 1e9);
        if (braked()) {
            ++moving_tick_;
            return;
        }
        plant_.advance_to(moving_tick_ * period_s_);
        const tools::JointVector speed = plant_.truth().velocity.cwiseAbs();
        peak_speed_ = std::max(peak_speed_, speed.maxCoeff());
        if (start_.size() > 0) {
            peak_distance_ =
                std::max(peak_distance_, (plant_.truth().position - start_).cwiseAbs().maxCoeff());
        }
        carry(fault);
        ++due_;
        if (fault.late_ticks == 0) {
            for (; due_ > 0; --due_) {
                tick_loop(fault);
            }
        }
        moving_tick_ += loop_->state() == tools::LoopState::waiting ? 0 : 1;
    }

    /// Sends the devices' frames of this tick to the loop.
    void carry(const LoopFault& fault) {
        loop_end_.set_time(now_ns_);
        wire_.set_time(now_ns_ + fault.clock_ns);
        tools::JointVector position = plant_.position();
        if (fault.reads) {
            fault.reads(position);
        }
        const tools::JointVector torque = plant_.torque();
        std::vector<hal::Frame> frames = devices_.joints(values(position), values(torque));
        if (const std::optional<hal::Frame> sync = devices_.sync()) {
            frames.insert(frames.begin(), *sync);
        }
        std::ranges::copy(devices_.heartbeats(), std::back_inserter(frames));
        if (has_sensor_) {
            std::ranges::copy(devices_.wrench({plant_.wrench().data(), 6}), std::back_inserter(frames));
        }
        for (const hal::Frame& frame : frames) {
            if (!fault.lost && !(fault.drops && fault.drops(frame))) {
                wire_.send(frame);
            }
        }
    }

    void tick_loop(const LoopFault& fault) {
        const auto period_ns = std::llround(period_s_ * 1e9);
        port_.receive(loop_end_, now_ns_ - (due_ - 1) * period_ns);
        tools::LoopInput input = port_.sense(now_ns_);
        input.deadline_missed = fault.given.deadline_missed;
        input.bus_lost = input.bus_lost || fault.given.bus_lost;
        input.stop_requested = fault.given.stop_requested;
        const tools::JointVector torque = loop_->tick(input);
        if (braked_tick_ < 0 && loop_->brake_requested()) {
            braked_tick_ = moving_tick_ + static_cast<int>(std::lround(0.2 / period_s_));
        }
        const auto step = (torque - command_).cwiseQuotient(limit_).cwiseAbs();
        peak_step_ = torque.allFinite() ? std::max(peak_step_, step.maxCoeff())
                                        : std::numeric_limits<double>::infinity();
        command_ = torque;
        if (loop_->state() != tools::LoopState::waiting) {
            port_.send(loop_end_, torque);
            for (const hal::Frame& frame : wire_.drain(room_)) {
                torques_.take(frame, {drive_.data(), static_cast<std::size_t>(drive_.size())});
            }
            plant_.apply(drive_);
        }
    }

    double period_s_;
    tools::MemoryBus loop_end_, wire_;
    tools::LoopPort port_;
    tools::DeviceFrames devices_;
    tools::TorqueFrames torques_;
    bool has_sensor_;
    std::unique_ptr<tools::ControlLoop> loop_;
    tools::JointVector limit_;
    tools::SimulatedPlant plant_;
    tools::JointVector command_, drive_, start_;
    std::array<hal::Frame, 256> room_{};
    std::int64_t now_ns_ = 0;
    int tick_ = 0, moving_tick_ = 0, due_ = 0;
    int braked_tick_ = -1;
    double peak_step_ = 0, peak_speed_ = 0, peak_distance_ = 0;
};

} // namespace dfdyn::tests
