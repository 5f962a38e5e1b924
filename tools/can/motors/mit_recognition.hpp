// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/mit_motor.hpp"
#include "tools/can/description/bus_fields.hpp"
#include "tools/can/families/motor_type.hpp"
#include "tools/can/motors/codec_fit.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

/// Distinguishes the frames of one motor from a selection of other frames: they come at even intervals, and
/// their temperatures change slowly.
class SteadyBytes {
  public:
    void take(const hal::Frame& frame);
    /// `alone`: no other motor has the identifier, so that intervals need not be even.
    bool is_steady(bool alone) const;

  private:
    hal::Frame last_;
    std::uint64_t steps_ = 0, jumps_ = 0;
    std::vector<std::int64_t> intervals_ns_;
};

/// A motor with MIT mode that may have sent some frames of a bus.
struct MitCandidate {
    std::uint32_t feedback_id = 0;
    unsigned motor = 0;
    std::uint64_t frames = 0; ///< frames of this motor
    std::uint64_t of_id = 0;  ///< frames of all motors on its identifier
    double plausibility = 0;  ///< mean of `plausible` over its frames
    SteadyBytes steady;
    CodecFit fit; ///< fit with `assumed`
    /// Another identifier with steady frames of its number, which do not fit as well.
    std::optional<std::uint32_t> other_id;
    static constexpr Maxima assumed{12.5, 30, 10};
    static constexpr double least_plausibility = 1.5;
};

/// Removes the candidates of identifiers on which several together leave more than a few frames unexplained,
/// because byte 0 is then not a motor number.
void drop_selections(std::vector<MitCandidate>& candidates);

/// Keeps one candidate of each motor: the one whose frames are clearly more plausible than those of the
/// other, as on the family's usual identifier. Without such a one, or with three or more identifiers, byte 0
/// is not a motor number, and none is kept.
void drop_repeated_motors(std::vector<MitCandidate>& candidates);

/// Returns the share of the frames of an identifier that its candidates explain. Other frames on the
/// identifier of a motor that answers on its own one are commands.
double explained_share(const MitCandidate& candidate, std::span<const MitCandidate> candidates);

/// Returns the frames by identifier and motor, with their plausibility. `Protocol`: a MitProtocol.
/// `plausible(frame)`: 0 (not such a frame) to 1.
template <hal::MitProtocol Protocol, class Plausible>
std::vector<MitCandidate> mit_groups(FrameSpan frames, Plausible plausible) {
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
        const bool feedback = Protocol::is_feedback(frame, motor);
        candidate.plausibility += feedback ? plausible(frame) : 1;
        if (feedback) {
            candidate.steady.take(frame);
        }
    }
    std::vector<MitCandidate> groups;
    for (auto& [key, candidate] : found) {
        candidate.of_id = all[candidate.feedback_id];
        candidate.plausibility /= static_cast<double>(candidate.frames);
        groups.push_back(std::move(candidate));
    }
    return groups;
}

/// Returns the groups that are steady feedback of a motor, with the codec's fit.
template <hal::MitProtocol Protocol, class Plausible>
std::vector<MitCandidate> mit_candidates(FrameSpan frames, double position_max, bool own_id,
                                         Plausible plausible) {
    std::vector<MitCandidate> candidates;
    for (MitCandidate& candidate : mit_groups<Protocol>(frames, plausible)) {
        const bool command = !own_id && candidate.feedback_id == candidate.motor;
        const bool rare = 20 * candidate.frames < candidate.of_id;
        if (candidate.motor == 0 || command || rare || candidate.frames < frames_to_recognise ||
            candidate.plausibility < MitCandidate::least_plausibility ||
            !candidate.steady.is_steady(5 * candidate.frames > 4 * candidate.of_id)) {
            continue;
        }
        candidate.fit = fit_codec(hal::MitMotor<Protocol>({.motor_id = static_cast<int>(candidate.motor),
                                                           .feedback_id = candidate.feedback_id,
                                                           .position_max = position_max,
                                                           .velocity_max = MitCandidate::assumed[1],
                                                           .torque_max = MitCandidate::assumed[2],
                                                           .shared_feedback_id = true}),
                                  frames);
        if (candidate.fit.fits() && !candidate.fit.joint[0].velocity.is_unrelated()) {
            candidates.push_back(std::move(candidate));
        }
    }
    drop_selections(candidates);
    drop_repeated_motors(candidates);
    return candidates;
}

/// Maxima of a motor's codes, as far as the frames determine them.
struct MeasuredMaxima {
    Maxima maxima{};      ///< the most likely maxima
    std::string measured; ///< for the report
    std::string unsure;   ///< uncertain properties; "": none
};

/// Parameters of the search for motors of one family.
struct MotorSearch {
    std::span<const MotorType> types;
    std::string_view ask; ///< instruction to obtain the maxima, for the report
    unsigned last_motor = 255;
    bool own_id = false; ///< motors may answer on the identifier of their commands
};

/// Finds the types whose velocity maximum is the one that relates the codes of velocity to the changes of
/// position. `assumed`: the velocity maximum that `velocity` was decoded with. `known`: maxima that the motor
/// itself reported, 0 if it did not.
MeasuredMaxima measure_maxima(const VelocityCheck& velocity, double assumed, const MotorSearch& search,
                              const Maxima& known);

/// Adds a motor whose feedback was decoded with `assumed` as velocity maximum. `entry`: its fields of
/// `boards` besides the maxima.
void add_motor(unsigned motor, const JointFit& fit, double assumed, const MotorSearch& search,
               const Maxima& known, nlohmann::json entry, Recognition& recognition);

/// Adds the identifier of the motor's commands if some come. Those of its other modes may be other devices'.
template <hal::MitProtocol Protocol>
void add_own_commands(FrameSpan frames, unsigned motor, std::set<BusStreamKey>& identifiers) {
    const hal::MitMotor<Protocol> codec({.motor_id = static_cast<int>(motor), .feedback_id = 0x7FE});
    const auto own = [&](const hal::Frame& frame) {
        return hal::has_id(frame, motor) && codec.command(frame) != hal::MotorCommand::none;
    };
    if (std::ranges::count_if(frames, own) >= static_cast<std::ptrdiff_t>(frames_to_recognise)) {
        identifiers.insert({false, motor});
    }
}

/// Recognises motors with MIT mode. `known(candidate)`: the maxima that a motor itself reported.
template <hal::MitProtocol Protocol, class Plausible, class Known>
Recognition recognise_mit_motors(FrameSpan frames, const MotorSearch& search, Plausible plausible,
                                 Known known) {
    Recognition recognition;
    recognition.quantity = "tau";
    std::vector<MitCandidate> candidates =
        mit_candidates<Protocol>(frames, search.types.front().maxima[0], search.own_id, plausible);
    std::ranges::sort(candidates, {}, &MitCandidate::motor);
    std::set<unsigned> answering;
    for (const MitCandidate& candidate : candidates) {
        if (candidate.motor > search.last_motor) {
            continue;
        }
        add_motor(candidate.motor, candidate.fit.joint[0], MitCandidate::assumed[1], search, known(candidate),
                  {{"feedback_id", identifier_text(candidate.feedback_id)}}, recognition);
        if (candidate.other_id) {
            recognition.unsure.push_back("motor " + std::to_string(candidate.motor) + ": frames on " +
                                         identifier_text(*candidate.other_id) +
                                         " have its number, too; they are not in the draft");
        }
        recognition.identifiers.insert({false, candidate.feedback_id});
        recognition.score += static_cast<double>(candidate.frames) * candidate.plausibility *
                             explained_share(candidate, candidates);
        add_own_commands<Protocol>(frames, candidate.motor, recognition.identifiers);
        answering.insert(candidate.motor);
    }
    for (const MitCandidate& candidate : candidates) {
        answering.insert(candidate.feedback_id); // its frames are not commands to a motor of that number
    }
    if (!recognition.boards.empty()) {
        recognition.silent = silent_motors(frames, 1, search.last_motor, answering, [](unsigned motor) {
            return hal::MitMotor<Protocol>({.motor_id = static_cast<int>(motor), .feedback_id = 0x7FE});
        });
    }
    return recognition;
}

} // namespace dfdyn::tools
