// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/task/task.hpp"

#include <memory>

namespace dfdyn::tools {

/// A task that can stop on its path and continue from another position.
///
/// A pause slows the time of the task to zero within `pause_s`, so that the reference stays on its path. To
/// continue, the time speeds up to its normal rate, and the distance of the arm from the path decreases, both
/// on a fifth-order polynomial of `continue_s`. It lasts longer for a larger distance, so that the return is
/// not faster than 0.5 rad/s (m/s). Between two references of the task the position is a cubic Hermite
/// polynomial. Without a pause the references are those of the task.
class PausableTask final : public Task {
  public:
    static constexpr double pause_s = 0.1;
    static constexpr double continue_s = 1;

    PausableTask(std::unique_ptr<Task> task, double period_s);

    Reference next() override;

    /// Begins to slow down; during a return it also ends the return where it is.
    void pause();
    /// Continues from `position`, rad (m), at rest.
    void resume(const JointVector& position);

  private:
    void step_rate();
    /// Returns the reference on the path for the present rate of the time.
    Reference on_path() const;
    /// Adds what is left of the distance from the path.
    void add_distance(Reference& reference) const;

    std::unique_ptr<Task> task_;
    double period_s_;
    Reference before_, after_;           ///< neighbours of the present time of the task
    double phase_ = 0;                   ///< between them, 0 … 1
    double rate_ = 1, acceleration_ = 0; ///< of the task's time: s/s, 1/s
    bool pausing_ = false;
    JointVector distance_; ///< from the path when the return began; empty: no return
    double since_s_ = 0, return_s_ = 0;
};

} // namespace dfdyn::tools
