// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"

#include <ostream>

namespace dfdyn::tools {

/// The hardest that an arm was treated, joint by joint.
class LoopPeaks {
  public:
    /// The command of one tick, N·m.
    void add(const JointVector& command);
    /// The same, and the true velocity (rad/s) when the tick began.
    void add(const JointVector& command, const JointVector& velocity);

    /// N·m, from one tick's command to the next one's; empty before the second.
    const JointVector& torque_step() const noexcept { return torque_step_; }
    /// rad/s; empty where none was known.
    const JointVector& speed() const noexcept { return speed_; }

  private:
    JointVector last_command_, torque_step_, speed_;
};

/// One line; none before the second tick.
void print_peaks(std::ostream& out, const LoopPeaks& peaks);

} // namespace dfdyn::tools
