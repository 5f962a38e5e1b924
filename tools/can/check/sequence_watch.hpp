// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace dfdyn::tools {

/// A persistent change of the phase of a regular sequence.
struct PhaseStep {
    std::int64_t time_ns; ///< time of the first frame after it
    double step_ns;       ///< modulo the period
};

/// Detects persistent changes of the phase of a regular sequence: eight consecutive frames with the same
/// offset. If all sources of a bus have one at the same time, its clock was set.
class PhaseSteps {
  public:
    /// Takes a frame that was due at `due_ns`, by a sequence that adapts slowly.
    void take(std::int64_t stamp_ns, double due_ns, double period_ns);

    /// Restarts after an interruption of the sequence.
    void interrupt() noexcept { frames_ = 0; }

    const std::vector<PhaseStep>& steps() const noexcept { return steps_; }

  private:
    std::vector<PhaseStep> steps_; ///< at most a few
    std::int64_t begin_ns_ = 0;    ///< time of the first frame with an offset
    double step_ns_ = 0;           ///< offset of that frame
    double next_ns_ = 0;           ///< expected time of the next one, if the change persists
    int frames_ = 0;               ///< consecutive frames with an offset; 0: none
    int settling_ = 0;             ///< frames until the sequence has adapted
};

/// Detects answers to a SYNC with a growing delay: five consecutive ones more than a quarter of a period off
/// the usual time.
class SyncAnswers {
  public:
    /// Takes the delay of an answer after the last SYNC.
    void take(std::int64_t after_ns, double period_ns);

    std::uint64_t late() const noexcept { return late_; }

  private:
    double usual_ns_ = 0; ///< circular mean of the first answers, because one may come after the next SYNC
    double cosine_sum_ = 0, sine_sum_ = 0; ///< over their phases
    int learned_ = 0;
    std::uint64_t run_ = 0, late_ = 0;
};

/// Compares the order in which the frames of a bus are read with the order of their time stamps.
class ReadingOrder {
  public:
    /// Takes the next frame that came at its place in the sequence of its source.
    void take(std::int64_t stamp_ns) noexcept;

    /// Number of frames read after one with a later time stamp; several within 10 ms count once.
    std::uint64_t overtaken() const noexcept { return overtaken_; }
    /// Returns true if the orders often differ.
    bool differs() const noexcept;

  private:
    std::int64_t latest_ns_ = std::numeric_limits<std::int64_t>::min();
    std::int64_t overtaken_ns_ = 0; ///< stamp of the last overtaken frame that was counted
    std::uint64_t overtaken_ = 0;
};

} // namespace dfdyn::tools
