// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/tools/control/pendulum.hpp"
#include "tools/control/loop_setup.hpp"

#include <memory>
#include <vector>

namespace dfdyn::tests {

/// Without an observer, so that the torque that holds the arm is the nominal weight alone.
inline const tools::LoopLimits no_observer{{}, {}, tools::StopMode::hold, {0}};

/// A loop with a pendulum that rests at the start of the reference; the test runs it tick by tick.
class LoopBench {
  public:
    explicit LoopBench(const tools::Scenario& scenario, const tools::LoopLimits& limits = {})
        : loop_(tools::make_control_loop(test_pendulum(), scenario, "test", nullptr, 0, limits)),
          position_(loop_->reference().position) {}

    double tick(bool valid = true, bool stop = false) {
        tools::LoopInput input;
        input.stop_requested = stop;
        return tick(input, valid);
    }
    double tick(tools::LoopInput input, bool valid = true) {
        input.time_ns = 1'000'000 * ticks_++;
        input.position = valid ? &position_ : nullptr;
        return loop_->tick(input)[0];
    }
    /// A tick that begins late, and finds the sample `ahead` ticks later.
    void late_tick(int ahead, const std::vector<bool>* missing) {
        tools::LoopInput input;
        input.deadline_missed = true;
        input.time_ns = 1'000'000 * (ticks_++ + ahead);
        input.position = &position_;
        input.missing = missing;
        loop_->tick(input);
    }
    tools::ControlLoop& loop() { return *loop_; }
    tools::JointVector& position() { return position_; }

  private:
    std::unique_ptr<tools::ControlLoop> loop_;
    tools::JointVector position_;
    std::int64_t ticks_ = 0;
};

} // namespace dfdyn::tests
