// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"
#include "dfdyn/core/strict_math.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dfdyn {

/// Recognises a joint that its feedback makes vibrate, as on an elastic gear: the torque turns `turns` times
/// in a row, each time within `longest_s` and by at least `swing`. Motions and friction at reversals turn the
/// torque more slowly, or once. Noise and the counts of an encoder move it by most of the way in one tick:
/// the largest change in a tick must be less than the way divided by `smooth`, unless the way is `large`
/// swings. Cost per joint and tick: 7 comparisons and 2 additions, at a turn 4 comparisons and 3
/// multiply-adds more; 7 n + 1 scalars. Never allocates.
template <class Scalar, int n>
class VibrationWatch {
  public:
    using Torques = Storage<Scalar, n>; ///< n values, N·m (N for prismatic joints)

    static constexpr Scalar longest_s = Scalar(0.1); ///< half a period of 5 Hz
    static constexpr Scalar smooth = 2; ///< way between two turns by the largest change in a tick
    static constexpr Scalar large = 3;  ///< way, by `swing`, for which `smooth` is not demanded
    static constexpr int turns = 8;     ///< four periods

    /// `period_s`: of a control tick, > 0.
    VibrationWatch(Extent<n> joint_count, Scalar period_s) noexcept
        : longest_ticks_(static_cast<std::int32_t>(longest_s / period_s)), peak_(Torques::zeros(joint_count)),
          last_peak_(peak_), last_(peak_), change_(peak_), direction_(Counts::zeros(joint_count)),
          ticks_(direction_), turns_(direction_) {}

    /// Forgets the past of all joints.
    void restart() noexcept {
        for (int k = 0; k < peak_.size(); ++k) {
            peak_[k] = last_peak_[k] = last_[k] = change_[k] = 0;
            direction_[k] = ticks_[k] = turns_[k] = 0;
        }
    }

    /// Passes a tick without a torque of joint `k`.
    void pass(int k) noexcept { ticks_[k] = std::min(ticks_[k] + 1, longest_ticks_ + 1); }

    /// Adds the torque of joint `k` in this tick, N·m. One that is not finite is none. `swing`: of the joint,
    /// N·m; one that is not > 0 finds nothing. Returns whether the joint has now turned `turns` times; the
    /// count then begins anew.
    bool vibrates(int k, Scalar torque, Scalar swing) noexcept {
        pass(k);
        if (!std::isfinite(torque)) {
            return false;
        }
        change_[k] = std::max(change_[k], std::abs(torque - last_[k]));
        last_[k] = torque;
        const bool rises = direction_[k] >= 0;
        const Scalar back = rises ? peak_[k] - torque : torque - peak_[k];
        if (back < 0) {
            peak_[k] = torque;
        }
        if (!(swing > 0) || back < swing) {
            return false;
        }
        turn(k, rises, torque, swing);
        const bool vibrates = turns_[k] >= turns;
        turns_[k] = vibrates ? 0 : turns_[k];
        return vibrates;
    }

  private:
    using Counts = Storage<std::int32_t, n>;

    void turn(int k, bool rises, Scalar torque, Scalar swing) noexcept {
        const Scalar way = std::abs(peak_[k] - last_peak_[k]);
        const bool even = way >= smooth * change_[k] || way >= large * swing;
        const bool counts = even && ticks_[k] <= longest_ticks_;
        turns_[k] = counts ? turns_[k] + 1 : 0;
        ticks_[k] = 0;
        change_[k] = 0;
        direction_[k] = rises ? -1 : 1;
        last_peak_[k] = peak_[k];
        peak_[k] = torque;
    }

    std::int32_t longest_ticks_;
    Torques peak_;      ///< extreme since the last turn, N·m
    Torques last_peak_; ///< the one before
    Torques last_;      ///< in the last tick
    Torques change_;    ///< largest one in a tick since the last turn, N·m
    Counts direction_;  ///< since the last turn: -1 falls, otherwise rises
    Counts ticks_;      ///< since the last turn
    Counts turns_;      ///< in a row
};

} // namespace dfdyn
