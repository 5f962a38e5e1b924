// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace dfdyn::tools {

/// A lasting change of the phase of a regular sequence.
struct PhaseStep {
    std::int64_t time_ns; ///< of the first frame after it
    double step_ns;       ///< modulo the period
};

/// Finds lasting changes of the phase of a regular sequence: eight frames in a row that are all off by the
/// same time. If all sources of a bus have one at the same time, its clock was set.
class PhaseSteps {
  public:
    /// Takes a frame that was due at `due_ns`, by a sequence that follows its frames slowly.
    void take(std::int64_t stamp_ns, double due_ns, double period_ns);

    /// The sequence is interrupted.
    void interrupt() noexcept { frames_ = 0; }

    const std::vector<PhaseStep>& steps() const noexcept { return steps_; }

  private:
    std::vector<PhaseStep> steps_; ///< at most a few
    std::int64_t begin_ns_ = 0;    ///< of the frames that are off
    double step_ns_ = 0;           ///< of the first of them
    double next_ns_ = 0;           ///< if the change lasts
    int frames_ = 0;               ///< that are off in a row; 0: none
    int settling_ = 0;             ///< frames until the sequence has followed
};

/// Finds answers to a SYNC that come ever later: five in a row more than a quarter of a period off the usual
/// time.
class SyncAnswers {
  public:
    /// Takes the time of an answer after the last SYNC.
    void take(std::int64_t after_ns, double period_ns);

    std::uint64_t late() const noexcept { return late_; }

  private:
    double usual_ns_ = 0; ///< circular mean of the first answers, because one may come after the next SYNC
    double cosine_sum_ = 0, sine_sum_ = 0; ///< of their phases
    int learned_ = 0;
    std::uint64_t run_ = 0, late_ = 0;
};

} // namespace dfdyn::tools
