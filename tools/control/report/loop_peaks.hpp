// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"

#include <ostream>

namespace dfdyn::tools {

/// Largest torque steps and speeds of a run, per joint.
class LoopPeaks {
  public:
    /// Adds the command of one tick, N·m.
    void add(const JointVector& command);
    /// Adds the command of one tick and the true velocity (rad/s) at its start.
    void add(const JointVector& command, const JointVector& velocity);

    /// Largest change of the command between successive ticks, N·m; empty before the second tick.
    const JointVector& torque_step() const noexcept { return torque_step_; }
    /// Largest speed, rad/s; empty if unknown.
    const JointVector& speed() const noexcept { return speed_; }

  private:
    JointVector last_command_, torque_step_, speed_;
};

/// Prints the peaks on one line; nothing before the second tick.
void print_peaks(std::ostream& out, const LoopPeaks& peaks);

} // namespace dfdyn::tools
