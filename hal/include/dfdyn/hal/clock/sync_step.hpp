// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace dfdyn::hal {

/// Data of the last two answers of a device. O(1).
class AnswerContents {
  public:
    /// Takes an answer and returns true if it has the same data as one of the two before.
    constexpr bool take(const Frame& frame) noexcept {
        Data data{};
        std::copy_n(frame.data.begin(), data.size(), data.begin());
        const bool repeats = data == last_[0] || data == last_[1];
        last_ = {data, last_[0]};
        return repeats;
    }

  private:
    using Data = std::array<std::uint8_t, 8>;
    std::array<Data, 2> last_{};
};

/// Decides if a device's answer to a SYNC belongs to the last SYNC. A device answers each SYNC once. An
/// answer is in step unless one of these holds:
/// - It is the second one since the SYNC: one of the two is late.
/// - It may be the answer to a later SYNC that was lost: it comes three quarters of a period later than the
///   earliest answers, and not at the usual time.
/// - The SYNC before had no answer, and this one is not at the usual time. It may be the missing one, and
///   then the device may stay late by a period. No answer is in step until a second answer followed a SYNC
///   for each missing one, or 200 came at the usual time. Exception: the next SYNC shows that one between was
///   lost, after which this answer was at its usual time.
///
/// O(1).
class SyncStep {
  public:
    constexpr void sync(std::int64_t stamp_ns) noexcept {
        if (synchronised_) {
            explain_late_answer(stamp_ns - sync_ns_);
            learn_period(stamp_ns - sync_ns_);
            missing_ += answered_ && answers_ == 0 && missing_ < max_missing ? 1 : 0;
        }
        synchronised_ = true;
        sync_ns_ = stamp_ns;
        answers_ = 0;
    }

    /// Takes an answer and returns true if it is in step; false before the first SYNC. `repeats`: it has the
    /// same content as one of the two before, and may be a copy. Then two answers do not prove that the
    /// device caught up.
    constexpr bool answer(std::int64_t stamp_ns, bool repeats = false) noexcept {
        answered_ = true;
        if (!synchronised_ || (repeats && answers_ > 0)) {
            return false;
        }
        first_repeats_ = answers_ == 0 ? repeats : first_repeats_;
        const std::int64_t after_ns = stamp_ns - sync_ns_;
        const bool usual = usual_ns_ >= 0 && distance(after_ns, usual_ns_) <= period_ns_ / 8 &&
                           distance(after_ns + period_ns_, usual_ns_) > period_ns_ / 4;
        late_ = period_ns_ > 0 && !usual && after_ns - earliest_ns_ > period_ns_ - period_ns_ / 4;
        if (after_ns < 0) { // one of the two stamps is wrong
            return false;
        }
        ++answers_;
        if (answers_ > 1) {
            const bool catches_up =
                after_ns <= period_ns_ && !first_repeats_; // a later one may answer a SYNC that was lost
            missing_ -= catches_up && missing_ > 0 ? 1 : 0;
            behind_ = (behind_ || late_ns_ >= 0) && missing_ > 0; // 0: none is missing
            late_ns_ = -1;
            return false;
        }
        if (period_ns_ == 0) {
            return true;
        }
        if (late_) {
            late_ns_ = after_ns;
            usual_answers_ = 0;
            return false;
        }
        return at_its_time(after_ns, usual);
    }

    /// Returns true if the last answer was so late that it may belong to a lost SYNC after the last one. It
    /// is no evidence about the value at the last SYNC.
    [[nodiscard]] constexpr bool late() const noexcept { return late_; }

    /// Returns the stamp of the last SYNC.
    [[nodiscard]] constexpr std::int64_t sync_ns() const noexcept { return sync_ns_; }

  private:
    static constexpr int answers_to_recover = 200;
    static constexpr int max_missing = 1000;

    [[nodiscard]] static constexpr std::int64_t distance(std::int64_t a, std::int64_t b) noexcept {
        return a < b ? b - a : a - b;
    }

    /// Returns true if an answer that is not too late is in step.
    constexpr bool at_its_time(std::int64_t after_ns, bool usual) noexcept {
        behind_ = behind_ || (missing_ > 0 && !usual);
        if (behind_) {
            usual_answers_ = usual ? usual_answers_ + 1 : 0;
            behind_ = usual_answers_ < answers_to_recover;
            return false;
        }
        usual_answers_ = 0;
        missing_ = 0;
        learn_usual_time(after_ns, usual);
        return true;
    }

    /// Explains a single late answer since the SYNC that was `interval_ns` before this one.
    constexpr void explain_late_answer(std::int64_t interval_ns) noexcept {
        if (late_ns_ < 0) {
            return;
        }
        const std::int64_t lost = (interval_ns + period_ns_ / 2) / period_ns_ - 1;
        const std::int64_t periods = (late_ns_ - usual_ns_ + period_ns_ / 2) / period_ns_;
        const bool to_a_lost_one = usual_ns_ >= 0 && periods >= 1 && periods <= lost &&
                                   distance(late_ns_ - periods * period_ns_, usual_ns_) <= period_ns_ / 8;
        behind_ = behind_ || (missing_ > 0 && !to_a_lost_one);
        missing_ = to_a_lost_one ? 0 : missing_;
        late_ns_ = -1;
    }

    /// Tracks the usual time from SYNC to answer. A different time is adopted only after 500 answers, because
    /// on a loaded bus answers are temporarily late.
    constexpr void learn_usual_time(std::int64_t after_ns, bool usual) noexcept {
        constexpr int answers_to_adapt = 500;
        earliest_ns_ = usual_ns_ < 0 ? after_ns : std::min(earliest_ns_, after_ns);
        unusual_ = usual ? 0 : std::min(unusual_ + 1, answers_to_adapt);
        if (usual) {
            usual_ns_ += (after_ns - usual_ns_) / 64; // slower than the delays of a bus that fills
        } else if (usual_ns_ < 0 || unusual_ == answers_to_adapt) {
            usual_ns_ = earliest_ns_ = after_ns;
        }
    }

    /// Tracks the period. A change of more than a quarter is adopted after eight in a row.
    constexpr void learn_period(std::int64_t interval_ns) noexcept {
        constexpr int intervals_to_adapt = 8;
        if (period_ns_ > 0 && distance(interval_ns, period_ns_) > period_ns_ / 4 &&
            unusual_intervals_ < intervals_to_adapt) {
            ++unusual_intervals_;
            return;
        }
        period_ns_ = unusual_intervals_ == intervals_to_adapt || period_ns_ == 0
                         ? interval_ns
                         : period_ns_ + (interval_ns - period_ns_) / 8;
        unusual_intervals_ = 0;
    }

    std::int64_t sync_ns_ = 0;
    std::int64_t period_ns_ = 0;
    std::int64_t usual_ns_ = -1;   ///< from a SYNC to its answer; -1: unknown
    std::int64_t earliest_ns_ = 0; ///< the shortest of those times
    std::int64_t late_ns_ = -1;    ///< time of a single too late answer since the last SYNC; -1: none
    int unusual_ = 0;              ///< answers in a row that were not at the usual time
    int unusual_intervals_ = 0;    ///< intervals in a row that differed from the period
    int answers_ = 0;              ///< since the last SYNC
    bool synchronised_ = false;
    bool answered_ = false;
    bool first_repeats_ = false; ///< the first answer since the last SYNC may be a copy
    int missing_ = 0;            ///< answers to earlier SYNCs that may still come
    bool late_ = false;          ///< the last answer was too late
    bool behind_ = false;        ///< all answers may belong to the SYNC before
    int usual_answers_ = 0;      ///< in a row, while `behind_`
};

} // namespace dfdyn::hal
