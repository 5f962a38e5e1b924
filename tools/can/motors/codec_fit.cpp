// SPDX-License-Identifier: Apache-2.0
#include "tools/can/motors/codec_fit.hpp"

namespace dfdyn::tools {

void JointFit::take(const hal::JointValue& value) noexcept {
    velocity.take(value);
    efforts += value.effort_reason != hal::Reason::no_output ? 1 : 0;
    if (value.position_reason == hal::Reason::waiting_for_position) {
        return;
    }
    constexpr double fastest = 60; ///< rad/s
    constexpr double least_jump_rad = 0.1;
    const double step_s = 1e-9 * static_cast<double>(value.stamp_ns - last_ns);
    const double step_rad = std::abs(value.position_rad - last_rad);
    jumps += positions > 0 && step_rad > least_jump_rad && step_rad > fastest * step_s ? 1 : 0;
    at_end += value.position_reason == hal::Reason::position_out_of_range ? 1 : 0;
    first_ns = positions == 0 ? value.stamp_ns : first_ns;
    last_ns = value.stamp_ns;
    last_rad = value.position_rad;
    lowest_rad = std::min(lowest_rad, last_rad);
    highest_rad = std::max(highest_rad, last_rad);
    ++positions;
}

bool CodecFit::fits() const noexcept {
    constexpr std::uint64_t most_bad = 10; ///< the largest share of bad frames is 1 / most_bad
    const std::uint64_t positions = joint[0].positions + joint[1].positions;
    const std::uint64_t jumps = joint[0].jumps + joint[1].jumps;
    const std::uint64_t at_end = joint[0].at_end + joint[1].at_end;
    return positions >= frames_to_recognise && 2 * at_end < positions && most_bad * rejected <= values &&
           most_bad * jumps <= positions;
}

} // namespace dfdyn::tools
