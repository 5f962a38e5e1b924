// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"
#include "dfdyn/hal/gate/send_rate.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace dfdyn::hal {

/// Joins the two frames of one wrench, which have no counter. They belong together if the second has its
/// stamp at most `delay` after the first, and no later wrench can have been sent by then. So halves of
/// different wrenches are never joined, even if frames wait for the bus for most of a period. Ambiguous
/// halves are not joined either. Frames that arrive out of order, but with stamps in order, are joined.
/// Frames that share one stamp (`StampSource::arrival`) are joined in their order; a loss among them is not
/// detected.
class PairGate {
  public:
    /// Of the sensor's wrenches; `delay` also covers the time that the two frames take.
    using Config = SendRateGate::Config;

    explicit constexpr PairGate(const Config& config) noexcept
        : delay_ns_(config.delay_ns), rate_{SendRateGate(config), SendRateGate(config)} {}

    enum class Result : std::uint8_t {
        waiting,  ///< for the other half
        paired,   ///< `first()` and `second()` are one wrench
        orphaned, ///< a half without its partner, with the stamp `orphan_ns()`
        doubled   ///< another sender uses the identifier; a pending half is discarded
    };

    /// Takes a frame; `part` is 0 or 1.
    constexpr Result push(int part, const Frame& frame) noexcept {
        const auto mine = static_cast<std::size_t>(part);
        if (rate_[mine].too_soon(frame.stamp_ns)) {
            reset();
            ++doubles_;
            return Result::doubled;
        }
        const bool replaced = pending_[mine];
        if (replaced) {
            drop(mine);
        }
        half_[mine] = frame;
        pending_[mine] = true;
        if (!pending_[1 - mine]) {
            return replaced ? Result::orphaned : Result::waiting;
        }
        return match(mine);
    }

    /// Discards a pending half after a loss of frames, because the next one may belong to another wrench.
    constexpr void reset() noexcept { pending_ = {}; }

    [[nodiscard]] constexpr const Frame& first() const noexcept { return half_[0]; }
    [[nodiscard]] constexpr const Frame& second() const noexcept { return half_[1]; }
    [[nodiscard]] constexpr std::int64_t orphan_ns() const noexcept { return orphan_ns_; }
    [[nodiscard]] constexpr std::uint64_t pairs() const noexcept { return pairs_; }

    /// Returns the number of first (0) or second (1) halves without a partner.
    [[nodiscard]] constexpr std::uint64_t unpaired(int part) const noexcept {
        return unpaired_[static_cast<std::size_t>(part)];
    }

    /// Returns how many times a second sender was detected.
    [[nodiscard]] constexpr std::uint64_t doubles() const noexcept { return doubles_; }

  private:
    constexpr void drop(std::size_t part) noexcept {
        pending_[part] = false;
        orphan_ns_ = half_[part].stamp_ns;
        ++unpaired_[part];
    }

    constexpr Result match(std::size_t newest) noexcept {
        const std::int64_t apart_ns = half_[1].stamp_ns - half_[0].stamp_ns;
        const bool in_order = newest == 1 ? apart_ns >= 0 : apart_ns > 0;
        if (!in_order || apart_ns > delay_ns_ || rate_[0].could_have_sent_again_by(half_[1].stamp_ns)) {
            drop(in_order ? 0 : 1); // the earlier one
            return Result::orphaned;
        }
        SendRateGate::sent_together(rate_[0], rate_[1]);
        pending_ = {};
        ++pairs_;
        return Result::paired;
    }

    std::int64_t delay_ns_;
    std::array<SendRateGate, 2> rate_;
    std::array<Frame, 2> half_{};
    std::array<bool, 2> pending_{};
    std::int64_t orphan_ns_ = 0;
    std::uint64_t pairs_ = 0;
    std::array<std::uint64_t, 2> unpaired_{};
    std::uint64_t doubles_ = 0;
};

} // namespace dfdyn::hal
