// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/task/task.hpp"

#include <memory>

namespace dfdyn::tools {

/// A task that can stop on its path, for good.
///
/// A pause slows the time of the task to zero within `pause_s`, so that the reference stays on its path.
/// Between two references of the task the position is a cubic Hermite polynomial. Without a pause the
/// references are those of the task.
class PausableTask final : public Task {
  public:
    static constexpr double pause_s = 0.1;

    PausableTask(std::unique_ptr<Task> task, double period_s);

    Reference next() override;

    /// Begins to slow down.
    void pause() noexcept { pausing_ = true; }

  private:
    void step_rate();
    /// Returns the reference on the path for the present rate of the time.
    Reference on_path() const;

    std::unique_ptr<Task> task_;
    double period_s_;
    Reference before_, after_;           ///< neighbours of the present time of the task
    double phase_ = 0;                   ///< between them, 0 … 1
    double rate_ = 1, acceleration_ = 0; ///< of the task's time: s/s, 1/s
    bool pausing_ = false;
};

} // namespace dfdyn::tools
