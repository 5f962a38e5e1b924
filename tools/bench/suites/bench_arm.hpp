// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <array>
#include <cstddef>

namespace dfdyn::tools {

/// An arm at 1 kHz for timing complete programs: six joints that move smoothly, and torques that depend on
/// the motion.
class BenchArm {
  public:
    static constexpr int joints = 6;
    static constexpr double period_s = 0.001;

    /// Returns model NP with input DFR and 2d = 200 columns, with random numbers.
    static TrainedModel model();

    void move_to(std::size_t row);
    double time_s() const { return time_s_; }
    const std::array<double, joints>& position() const { return position_; }
    const std::array<double, joints>& torque() const { return torque_; }

  private:
    double time_s_ = 0;
    std::array<double, joints> position_{}, torque_{};
};

} // namespace dfdyn::tools
