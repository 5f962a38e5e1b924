// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// A step between two positions that no joint can make.
struct PositionJump {
    std::int64_t time_ns = 0;
    double from_rad = 0, to_rad = 0; ///< position extrapolated from the motion before, and measured position
    double count_rad = 0;            ///< smallest step of the encoder
    double from_zero_rad = 0;        ///< position after the step, relative to the device's zero
    double period_s = 0;             ///< mean interval between positions before it
    bool turn = false;               ///< whole turns of the encoder
    bool one_turn = false;           ///< one turn, like the wrap of a single-turn encoder
    bool after_silence = false;      ///< also after a fault or zeros, like a restart
    bool absolute = false;           ///< the encoder cannot lose its zero
    bool replays = false;            ///< the positions after it repeat those of an earlier time

    double step_rad() const noexcept { return to_rad - from_rad; }
};

/// Cause of a jump.
enum class JumpCause : std::uint8_t {
    bits_flipped,
    bit_stuck,
    frames_replayed,
    zero_lost,
    nodes_swapped,
    wrap,
    unknown
};

/// Detects if the positions after a jump repeat those of an earlier time.
class ReplayedPositions {
  public:
    /// Takes the next position; `jumps`: it is the first after a jump. Returns true once for each jump to
    /// repeated positions.
    bool take(double position_rad, bool jumps);

  private:
    static constexpr std::size_t kept = 512;

    double before(std::size_t age) const { return positions_[(count_ - age) % kept]; }

    std::array<double, kept> positions_{};
    std::size_t count_ = 0;
    std::vector<std::size_t> ages_; ///< of earlier positions that are equal to those since the jump
    double first_rad_ = 0;
    bool moves_ = false;
    int equal_ = 0;
};

/// Returns the cause of each jump, for each joint of an arm.
std::vector<std::vector<JumpCause>> causes_of(std::span<const std::vector<PositionJump>> joints);

} // namespace dfdyn::tools
