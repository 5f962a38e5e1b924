// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/device/motor_command.hpp"
#include "tools/can/families/recognition.hpp"
#include "tools/can/motors/velocity_check.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace dfdyn::tools {

/// Returns the usual rate (Hz) of a sender. Pauses, single losses and clock steps do not change it. It is the
/// median over four intervals, because two answers may come per period. If an adapter delivers frames in
/// bursts, it is the mean over about 0.25 s. 0: fewer than two stamps, or none that increase.
double usual_rate_hz(std::span<const std::int64_t> stamps_ns);

/// Fit of a codec to the frames of a bus, for one joint.
struct JointFit {
    VelocityCheck velocity;
    std::uint64_t jumps = 0;  ///< between consecutive positions, faster than any joint
    std::uint64_t at_end = 0; ///< positions at an end of their code
    std::uint64_t efforts = 0;
    std::vector<std::int64_t> position_ns; ///< stamps of the positions
    double last_rad = 0;
    double lowest_rad = std::numeric_limits<double>::max(),
           highest_rad = std::numeric_limits<double>::lowest();

    double rate_hz() const { return usual_rate_hz(position_ns); }
    void take(const hal::JointValue& value);
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

/// Number of frames required to recognise a device.
inline constexpr std::uint64_t frames_to_recognise = 10;

/// Adds the identifiers of commands and polls to the motor of `codec`. Returns the number of these frames.
template <class Codec>
std::uint64_t add_commands(FrameSpan frames, const Codec& codec, std::set<BusStreamKey>& identifiers) {
    std::uint64_t commands = 0;
    for (const hal::Frame& frame : frames) {
        if (codec.command(frame) != hal::MotorCommand::none) {
            identifiers.insert({frame.extended, frame.id});
            ++commands;
        }
    }
    return commands;
}

/// Returns the motors of `first` … `last` that are commanded or polled, but are not among `answering`.
/// `codec_of(motor)`: a codec with `command`.
template <class CodecOf>
std::vector<SilentMotor> silent_motors(FrameSpan frames, unsigned first, unsigned last,
                                       const std::set<unsigned>& answering, CodecOf codec_of) {
    std::vector<SilentMotor> silent;
    for (unsigned motor = first; motor <= last; ++motor) {
        SilentMotor asked{.motor = motor};
        if (!answering.contains(motor) &&
            add_commands(frames, codec_of(motor), asked.commands) >= frames_to_recognise) {
            silent.push_back(std::move(asked));
        }
    }
    return silent;
}

} // namespace dfdyn::tools
