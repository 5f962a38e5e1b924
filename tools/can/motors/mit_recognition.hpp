// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/mit_motor.hpp"
#include "tools/can/families/motor_type.hpp"
#include "tools/can/motors/codec_fit.hpp"

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A motor with MIT mode that may have sent some frames of a bus.
struct MitCandidate {
    std::uint32_t feedback_id = 0;
    unsigned motor = 0;
    std::uint64_t frames = 0; ///< its own
    std::uint64_t of_id = 0;  ///< of all motors on its identifier
    std::uint64_t motors = 0; ///< on its identifier
    double plausibility = 0;  ///< mean of what `plausible` gave its frames
    CodecFit fit;             ///< with `assumed`
    static constexpr Maxima assumed{12.5, 30, 10};
    static constexpr double least_plausibility = 1.5;
};

/// Groups frames by identifier and motor. `Protocol`: a MitProtocol. `plausible(frame)`: 0 (not such a frame)
/// to 1.
template <hal::MitProtocol Protocol, class Plausible>
std::vector<MitCandidate> mit_candidates(FrameSpan frames, double position_max, Plausible plausible) {
    std::map<std::pair<std::uint32_t, unsigned>, MitCandidate> found;
    std::map<std::uint32_t, std::uint64_t> all;
    for (const hal::Frame& frame : frames) {
        if (frame.extended || frame.remote || frame.error || !Protocol::has_length(frame.length)) {
            continue;
        }
        ++all[frame.id];
        const unsigned motor = Protocol::motor_of(frame);
        MitCandidate& candidate = found[{frame.id, motor}];
        candidate.feedback_id = frame.id;
        candidate.motor = motor;
        ++candidate.frames;
        candidate.plausibility += Protocol::is_feedback(frame, motor) ? plausible(frame) : 1;
    }
    std::vector<MitCandidate> candidates;
    for (auto& [key, candidate] : found) {
        candidate.of_id = all[candidate.feedback_id];
        candidate.plausibility /= static_cast<double>(candidate.frames);
        const bool command = candidate.feedback_id == candidate.motor; // answers never come on it
        const bool rare = 20 * candidate.frames < candidate.of_id;
        if (candidate.motor == 0 || command || rare || candidate.frames < frames_to_recognise ||
            candidate.plausibility < MitCandidate::least_plausibility) {
            continue;
        }
        candidate.fit = fit_codec(hal::MitMotor<Protocol>({.motor_id = static_cast<int>(candidate.motor),
                                                           .feedback_id = candidate.feedback_id,
                                                           .position_max = position_max,
                                                           .velocity_max = MitCandidate::assumed[1],
                                                           .torque_max = MitCandidate::assumed[2],
                                                           .shared_feedback_id = true}),
                                  frames);
        if (candidate.fit.fits()) {
            candidates.push_back(candidate);
        }
    }
    for (MitCandidate& candidate : candidates) {
        candidate.motors = static_cast<std::uint64_t>(
            std::ranges::count(candidates, candidate.feedback_id, &MitCandidate::feedback_id));
    }
    return candidates;
}

/// What the frames tell about the maxima of a motor's codes.
struct MeasuredMaxima {
    Maxima maxima{};            ///< the most likely
    std::string measured;       ///< for the report
    std::string unsure;         ///< "": nothing is
    std::string_view type = {}; ///< the only type that fits; "" none or several
};

/// Finds the types whose velocity maximum is the one that relates the codes of velocity to the changes of
/// position. `assumed`: the velocity maximum that `velocity` was decoded with. `known`: maxima that the motor
/// itself reported, 0 if it did not. `ask`: how to learn the maxima.
MeasuredMaxima measure_maxima(const VelocityCheck& velocity, double assumed, std::span<const MotorType> types,
                              const Maxima& known, const std::string& ask);

} // namespace dfdyn::tools
