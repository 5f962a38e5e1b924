// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/device/motor_command.hpp"
#include "tools/can/families/recognition.hpp"
#include "tools/can/motors/velocity_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>
#include <vector>

namespace dfdyn::tools {

/// Fit of a codec to the frames of a bus, for one joint.
struct JointFit {
    VelocityCheck velocity;
    std::uint64_t positions = 0;
    std::uint64_t jumps = 0;  ///< between consecutive positions, faster than any joint
    std::uint64_t at_end = 0; ///< positions at an end of their code
    std::uint64_t efforts = 0;
    std::int64_t first_ns = 0, last_ns = 0;
    double last_rad = 0;
    double lowest_rad = std::numeric_limits<double>::max(),
           highest_rad = std::numeric_limits<double>::lowest();

    double rate_hz() const noexcept {
        return positions > 1 && last_ns > first_ns
                   ? 1e9 * static_cast<double>(positions - 1) / static_cast<double>(last_ns - first_ns)
                   : 0;
    }
    void take(const hal::JointValue& value) noexcept;
};

struct CodecFit {
    std::array<JointFit, 2> joint;
    std::uint64_t values = 0, rejected = 0;

    /// Returns true if the frames come from such a device: enough of them, well-formed, without jumps.
    bool fits() const noexcept;
};

/// Decodes the frames by `codec`. `joint`: the arm's joint of the codec's first one.
template <hal::JointSource Codec>
CodecFit fit_codec(Codec codec, FrameSpan frames, int joint = 0) {
    CodecFit fit;
    for (const hal::Frame& frame : frames) {
        const hal::Decoded decoded = codec.decode(frame);
        fit.rejected += decoded.kind == hal::Decoded::Kind::rejected ? 1 : 0;
        fit.values += decoded.kind == hal::Decoded::Kind::values ? 1 : 0;
        for (int i = 0; i < decoded.joints; ++i) {
            const hal::JointValue& value = decoded.joint[static_cast<std::size_t>(i)];
            fit.joint[value.joint == joint ? 0 : 1].take(value);
        }
    }
    return fit;
}

/// Returns the motors of `first` … `last` that are commanded or polled, but are not among `answering`.
/// `codec_of(motor)`: a codec with `command`.
template <class CodecOf>
std::vector<unsigned> silent_motors(FrameSpan frames, unsigned first, unsigned last,
                                    const std::set<unsigned>& answering, CodecOf codec_of) {
    constexpr int often = 10;
    std::vector<unsigned> silent;
    for (unsigned motor = first; motor <= last; ++motor) {
        const auto codec = codec_of(motor);
        const auto asked = [&](const hal::Frame& frame) {
            return codec.command(frame) != hal::MotorCommand::none;
        };
        if (!answering.contains(motor) && std::ranges::count_if(frames, asked) >= often) {
            silent.push_back(motor);
        }
    }
    return silent;
}

/// Number of frames required to recognise a device.
inline constexpr std::uint64_t frames_to_recognise = 10;

} // namespace dfdyn::tools
