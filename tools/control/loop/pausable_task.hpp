// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/task/task.hpp"

#include <memory>

namespace dfdyn::tools {

/// A task that can begin beside its path, and stop on it for good.
///
/// A lead-in goes straight to the path, all joints along one fifth-order polynomial, at `lead_in_speed` and
/// `lead_in_share` of the speed limits or slower. The task, which is at rest there, waits meanwhile.
///
/// A pause slows the time of the task to zero within `pause_s`, so that the reference stays on its path.
/// Between two references of the task the position is a cubic Hermite polynomial. Without a pause the
/// references are those of the task. A pause also slows the lead-in.
class PausableTask final : public Task {
  public:
    static constexpr double pause_s = 0.1;
    static constexpr double lead_in_speed = 0.25;     ///< rad/s, m/s
    static constexpr double lead_in_share = 0.25;     ///< of a joint's speed limit
    static constexpr double shortest_lead_in_s = 0.5; ///< s

    PausableTask(std::unique_ptr<Task> task, double period_s);

    Reference next() override;

    /// Begins a lead-in: the last reference was this far (rad, m) beside the path. `speed_limit`: rad/s, m/s
    /// per joint; empty: none.
    void lead_in(const JointVector& offset, const JointVector& speed_limit);
    /// Returns the offset at the begin of the lead-in, rad (m); zeros without one.
    const JointVector& lead_in_offset() const noexcept { return offset_; }
    /// Returns the duration of the lead-in, s; 0 without one.
    double lead_in_s() const noexcept { return lead_in_s_; }

    /// Begins to slow down.
    void pause() noexcept { pausing_ = true; }

  private:
    void step_rate();
    /// Returns the reference on the path for the present rate of the time.
    Reference on_path() const;
    bool leads_in() const noexcept { return led_s_ < lead_in_s_; }
    /// Returns the reference of the lead-in.
    Reference on_lead_in() const;

    std::unique_ptr<Task> task_;
    double period_s_;
    Reference before_, after_;           ///< neighbours of the present time of the task
    double phase_ = 0;                   ///< between them, 0 … 1
    double rate_ = 1, acceleration_ = 0; ///< of the task's time: s/s, 1/s
    bool pausing_ = false;
    JointVector offset_;               ///< at the begin of the lead-in
    double lead_in_s_ = 0, led_s_ = 0; ///< duration of the lead-in; time since its begin
};

} // namespace dfdyn::tools
