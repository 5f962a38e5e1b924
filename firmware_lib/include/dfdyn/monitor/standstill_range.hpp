// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn {

/// Learns the range of the prediction error of a stationary joint, which stiction causes without any load.
///
/// At standstill the friction torque has any value up to the break-away torque. The error of the predicted
/// torque then has an unknown level, which changes slowly while the controller and the contact relax. A
/// variance does not describe it: nearly all blocks of a long standstill are quiet, but the next stop is not.
/// The range therefore consists of two maxima in output units (N·m, A): the magnitude of the error, and that
/// of its change from block to block. A larger magnitude widens the range at once. Smaller ones narrow it
/// with a memory of `memory` standstills. After `longest_blocks` a standstill may only widen it.
///
/// After n standstills the bounds are larger by the factor 1 + `margin` / n, for values not seen yet. Memory:
/// 8 numbers.
template <class Scalar>
class StandstillRange {
  public:
    static constexpr Scalar needed = 4;  ///< standstills before the range is known
    static constexpr Scalar memory = 50; ///< standstills
    static constexpr Scalar margin = 2;
    static constexpr int longest_blocks = 50;
    /// Largest factor by which one standstill widens a known range: without an alarm, and during one.
    static constexpr Scalar growth = 10;
    static constexpr Scalar growth_in_alarm = Scalar(1.5);

    /// Adds a block at standstill. `level`: magnitude of the error, `change`: magnitude of its difference
    /// from the previous block, 0 in the first one; `alarm`: true during an alarm. Ignores non-finite values.
    void add(Scalar level, Scalar change, bool alarm) noexcept {
        level_.present = std::max(level_.present, level <= largest ? level : Scalar(0));
        change_.present = std::max(change_.present, change <= largest ? change : Scalar(0));
        in_alarm_ = in_alarm_ || alarm;
        if (++blocks_ >= longest_blocks) {
            close();
            after_motion_ = false;
        }
    }

    /// Ends the standstill, if there is one: the joint moves.
    void end() noexcept {
        if (blocks_ > 0) {
            close();
        }
        after_motion_ = true;
    }

    /// Learns the range again, starting from the present one.
    void relearn() noexcept { standstills_ = 0; }

    [[nodiscard]] bool known() const noexcept { return standstills_ >= needed; }
    /// Returns the largest usual magnitude of the error, output units. Only if `known()`.
    [[nodiscard]] Scalar level() const noexcept { return level_.usual * (1 + margin / standstills_); }
    /// Returns the largest usual magnitude of its change from block to block. Only if `known()`.
    [[nodiscard]] Scalar change() const noexcept { return change_.usual * (1 + margin / standstills_); }

  private:
    static constexpr Scalar largest = Scalar(1e15);

    struct Maximum {
        Scalar usual = 0, present = 0;

        void take_over(Scalar factor, bool may_fall) noexcept {
            const Scalar limit = usual > 0 ? factor * usual : largest;
            if (present > usual) {
                usual = std::min(present, limit);
            } else if (may_fall) {
                usual += (present - usual) / memory;
            }
            present = 0;
        }
    };

    void close() noexcept {
        const Scalar factor = !known() ? largest : in_alarm_ ? growth_in_alarm : growth;
        level_.take_over(factor, after_motion_ && !in_alarm_);
        change_.take_over(factor, after_motion_ && !in_alarm_);
        standstills_ = std::min(standstills_ + (after_motion_ ? 1 : 0), memory);
        blocks_ = 0;
        in_alarm_ = false;
    }

    Maximum level_, change_;
    Scalar standstills_ = 0;
    int blocks_ = 0;
    bool in_alarm_ = false, after_motion_ = true;
};

} // namespace dfdyn
