// SPDX-License-Identifier: Apache-2.0
#include "tools/can/check/position_jumps.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace dfdyn::tools {

namespace {

constexpr int replayed_positions = 10; ///< consecutive
constexpr double tolerance_counts = 3;
constexpr double near_rad = 0.02;   ///< motion between consecutive positions
constexpr double same_share = 0.25; ///< tolerance, as a fraction of a jump
constexpr double flip_periods = 6;  ///< until a flipped position has returned
constexpr double swap_periods = 5;  ///< between the jumps of two joints

bool within(const PositionJump& jump, const PositionJump& other, double periods) {
    return 1e-9 * std::abs(static_cast<double>(jump.time_ns - other.time_ns)) <=
           periods * std::max(jump.period_s, other.period_s);
}

bool is_near(double one, double other, double count_rad) {
    return std::abs(one - other) <= near_rad + tolerance_counts * count_rad;
}

/// Number of jumps until the position has returned at once, by consecutive flipped bits; 0: it has not. One
/// turn and back is a joint at rest where its encoder wraps.
std::size_t flips_after(std::span<const PositionJump> jumps) {
    constexpr std::size_t most_flips = 8;
    if (jumps[0].one_turn) {
        return 0;
    }
    for (std::size_t i = 1; i < std::min(jumps.size(), most_flips); ++i) {
        if (!within(jumps[i], jumps[0], flip_periods)) {
            break;
        }
        if (is_near(jumps[i].to_rad, jumps[0].from_rad, jumps[0].count_rad)) {
            return i;
        }
    }
    return 0;
}

/// Returns true if the second jump undoes the first.
bool returns(const PositionJump& jump, const PositionJump& back) {
    const double off_rad = std::abs(jump.step_rad() + back.step_rad());
    return off_rad <= std::max(same_share * std::abs(jump.step_rad()), near_rad);
}

bool is_power_of_two(const PositionJump& jump) {
    constexpr double rounding = 0.08; // fraction of the jump, for the motion meanwhile
    const double counts = std::abs(jump.step_rad()) / jump.count_rad;
    const double power = std::log2(std::max(counts, 1.0));
    return std::abs(counts / std::exp2(std::round(power)) - 1) < rounding;
}

bool swaps(const PositionJump& jump, const PositionJump& other) {
    return within(jump, other, swap_periods) && is_near(jump.to_rad, other.from_rad, jump.count_rad) &&
           is_near(other.to_rad, jump.from_rad, jump.count_rad);
}

bool is_swapped(const PositionJump& jump, const std::vector<PositionJump>& own,
                std::span<const std::vector<PositionJump>> joints) {
    return std::ranges::any_of(joints, [&](const std::vector<PositionJump>& jumps) {
        return &jumps != &own &&
               std::ranges::any_of(jumps, [&](const PositionJump& other) { return swaps(jump, other); });
    });
}

JumpCause cause_of(const PositionJump& jump, const PositionJump* back) {
    if (jump.replays) {
        return JumpCause::frames_replayed;
    }
    const bool wraps = jump.one_turn && !jump.after_silence;
    if (back == nullptr && !wraps && !jump.absolute && is_near(jump.from_zero_rad, 0, jump.count_rad)) {
        return JumpCause::zero_lost;
    }
    if (jump.turn) {
        return JumpCause::wrap;
    }
    return back != nullptr && is_power_of_two(jump) ? JumpCause::bit_stuck : JumpCause::unknown;
}

/// A stuck bit causes jumps of one size; flipped bits cause several sizes.
void separate_stuck_from_flipped(const std::vector<PositionJump>& jumps, std::vector<JumpCause>& causes) {
    constexpr double same_size = 1.6; // ratio of largest to smallest, for the motion meanwhile
    const auto of_bits = [](JumpCause cause) {
        return cause == JumpCause::bits_flipped || cause == JumpCause::bit_stuck ||
               cause == JumpCause::unknown;
    };
    double least = 0;
    double largest = 0;
    for (std::size_t i = 0; i < jumps.size(); ++i) {
        const double size = std::abs(jumps[i].step_rad());
        if (of_bits(causes[i])) {
            least = least == 0 ? size : std::min(least, size);
            largest = std::max(largest, size);
        }
    }
    const bool stuck = std::ranges::count(causes, JumpCause::bit_stuck) > 0;
    const bool flipped = std::ranges::count(causes, JumpCause::bits_flipped) > 0;
    if (!stuck) {
        return;
    }
    for (JumpCause& cause : causes) {
        if (of_bits(cause) && largest <= same_size * least) {
            cause = JumpCause::bit_stuck;
        } else if (of_bits(cause) && flipped) {
            cause = JumpCause::bits_flipped;
        }
    }
}

/// Turns that reverse at once, together with other flipped bits, are flipped bits, too.
void find_flipped_turns(const std::vector<PositionJump>& jumps, std::vector<JumpCause>& causes) {
    if (std::ranges::count(causes, JumpCause::bits_flipped) == 0) {
        return;
    }
    for (std::size_t i = 1; i < jumps.size(); ++i) {
        const bool both = causes[i - 1] == JumpCause::wrap && causes[i] == JumpCause::wrap;
        if (both && returns(jumps[i - 1], jumps[i]) && within(jumps[i - 1], jumps[i], flip_periods)) {
            causes[i - 1] = causes[i] = JumpCause::bits_flipped;
        }
    }
}

/// Returns the causes of a joint's jumps, in their order.
std::vector<JumpCause> causes_of_joint(const std::vector<PositionJump>& jumps,
                                       std::span<const std::vector<PositionJump>> joints) {
    std::vector<JumpCause> causes;
    for (std::size_t i = 0; i < jumps.size(); ++i) {
        if (const std::size_t flips = flips_after(std::span(jumps).subspan(i));
            flips > 0 && !jumps[i].replays && !is_swapped(jumps[i], jumps, joints)) {
            causes.insert(causes.end(), flips + 1, JumpCause::bits_flipped);
            i += flips;
            continue;
        }
        const bool ends = i + 1 < jumps.size() && (jumps[i].replays || returns(jumps[i], jumps[i + 1]));
        const PositionJump* const back = ends ? &jumps[i + 1] : nullptr;
        causes.push_back(is_swapped(jumps[i], jumps, joints) ? JumpCause::nodes_swapped
                                                             : cause_of(jumps[i], back));
        if (ends) { // by a jump of the same cause
            causes.push_back(causes.back());
            ++i;
        }
    }
    find_flipped_turns(jumps, causes);
    separate_stuck_from_flipped(jumps, causes);
    return causes;
}

} // namespace

bool ReplayedPositions::take(double position_rad, bool jumps) {
    if (jumps) {
        ages_.clear();
        for (std::size_t age = 2; age < std::min(count_, kept - 1); ++age) {
            if (before(age) == position_rad) {
                ages_.push_back(age);
            }
        }
        equal_ = 1;
        moves_ = false;
        first_rad_ = position_rad;
    } else if (!ages_.empty()) {
        std::erase_if(ages_, [&](std::size_t age) { return before(age) != position_rad; });
        moves_ = moves_ || position_rad != first_rad_;
        ++equal_;
    }
    positions_[count_ % kept] = position_rad;
    ++count_;
    const bool replays = !ages_.empty() && moves_ && equal_ >= replayed_positions;
    if (replays) {
        ages_.clear();
    }
    return replays;
}

std::vector<std::vector<JumpCause>> causes_of(std::span<const std::vector<PositionJump>> joints) {
    std::vector<std::vector<JumpCause>> causes;
    std::ranges::transform(joints, std::back_inserter(causes), [&](const std::vector<PositionJump>& jumps) {
        return causes_of_joint(jumps, joints);
    });
    return causes;
}

} // namespace dfdyn::tools
