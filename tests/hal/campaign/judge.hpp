// SPDX-License-Identifier: Apache-2.0
// What is right: the encoder's or sensor's resolution and the true motion decide, nothing else.
#pragma once

#include "tests/hal/campaign/sight.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace dfdyn::tests {

/// A fault in its place.
struct PlacedFault {
    const Fault* fault;
    std::int64_t begin_ns, end_ns;
    std::int64_t recovered_ns; ///< where it ends and those from which there was no recovery before it began

    [[nodiscard]] bool covers(std::int64_t time_ns) const {
        return time_ns >= begin_ns - 5 * bus_period && time_ns <= recovered_ns;
    }
};

/// How an accepted value compares with the truth.
enum class Match {
    wrong,
    undecidable, ///< off, where no receiver can tell it from a right one: docs/reference/faults.md
    right        ///< as the device measured it, or on the line between two measurements
};

/// A value that was accepted for an instant, and how long before it was measured if it is held.
struct Claim {
    double value;
    double time_s;    ///< by a clock whose error is known,
    double unknown_s; ///< or up to so much earlier
    hal::ValueOrigin origin;
};

/// Compares the values of one kind of arm with the truth. A frame that is `uninformative` ends no time
/// without a right reading, even where its position happens to be the true one: a receiver learns nothing
/// from zeros of a device that has no position yet, or from a position that is repeated.
class Judge {
  public:
    Judge(const CampaignArm& arm, const Truth& truth, const hal::MotionLimits& limits,
          std::span<const PlacedFault> faults, std::span<const JointSight> sight)
        : arm_(arm), truth_(truth), limits_(limits), faults_(faults), sight_(sight) {}

    /// Position of a joint; `true_ns`: when it was assembled.
    [[nodiscard]] Match position(std::size_t joint, const Claim& claim, std::int64_t true_ns) const {
        const auto truth = [&](double time_s) { return truth_.position(joint, time_s); };
        const double counts = 0.5 * arm_.step_rad[joint] + 1e-7; // a float has no more
        const double tolerance = counts + chord(Truth::most_acceleration, claim.origin);
        if (is_near(truth, claim, 0, 0, tolerance)) {
            return Match::right;
        }
        const double waits_s = sum(true_ns, [](const Fault& fault) { return fault.waits_s; });
        const double waited_s = arm_.synchronous ? 0 : waits_s;
        const auto may_be = [&](const JointSight::Shown& shown) { return after_silence(joint, shown); };
        const bool shown = is_shown(joint, &JointSight::Shown::position_rad, claim, tolerance, may_be);
        return shown || is_near(truth, claim, waited_s, 0, tolerance + within_limits(joint, claim))
                   ? Match::undecidable
                   : Match::wrong;
    }

    /// How far a position is off, and how far it may be where no receiver can tell it.
    [[nodiscard]] std::array<double, 2> explain(std::size_t joint, const Claim& claim) const {
        return {std::abs(claim.value - truth_.position(joint, claim.time_s)), within_limits(joint, claim)};
    }

    /// Channel of the wrench, or effort of a joint.
    [[nodiscard]] Match output(std::size_t channel, const Claim& claim, std::int64_t true_ns) const {
        const auto truth = [&](double time_s) {
            return arm_.efforts() ? truth_.effort(channel, time_s)
                                  : arm_.output_range * truth_.load(channel, time_s);
        };
        const double bend = arm_.efforts() ? Truth::effort_bend : arm_.output_range * Truth::load_bend;
        const double tolerance = noise() + chord(bend, claim.origin);
        if (is_near(truth, claim, 0, 0, tolerance)) {
            return Match::right;
        }
        const double waited_s = sum(true_ns, [](const Fault& fault) { return fault.waits_s; });
        const double late_s = sum(true_ns, [](const Fault& fault) { return fault.late_s; });
        const double early_s = sum(true_ns, [](const Fault& fault) { return fault.early_s; });
        const bool corrupted =
            !arm_.efforts() && std::ranges::any_of(faults_, [&](const PlacedFault& placed) {
                return placed.fault->alters_outputs && placed.covers(true_ns);
            });
        const double unseen = corrupted ? below_jumps() : 0;
        const bool near = is_near(truth, claim, waited_s + late_s, early_s, tolerance + unseen);
        return near || (arm_.efforts() && of_undecidable_joint(channel, claim, tolerance))
                   ? Match::undecidable
                   : Match::wrong;
    }

  private:
    /// Of values that are linear between two measurements.
    static double chord(double bend, hal::ValueOrigin origin) {
        const std::int64_t apart_ns = origin == hal::ValueOrigin::bridged ? bus_max_age
                                      : origin == hal::ValueOrigin::interpolated
                                          ? 3 * bus_period / 2 + bus_jitter
                                          : 0;
        return bend * seconds_of(apart_ns) * seconds_of(apart_ns) / 8;
    }

    /// The devices' noise of two counts, and the rounding.
    [[nodiscard]] double noise() const { return 2.5 * arm_.output_step + 1e-6; }

    /// Whether the truth was near the value at its instant or before, by the lateness of its frames.
    template <class Value>
    [[nodiscard]] bool is_near(Value value, const Claim& claim, double late_s, double early_s,
                               double tolerance) const {
        constexpr double step_s = 0.5e-3; // the truth is straight for so long, to a fraction of the tolerance
        const double latest_s = (arm_.synchronous ? 0 : seconds_of(bus_jitter)) + claim.unknown_s + late_s;
        for (double late = -early_s; late < latest_s + step_s; late += step_s) {
            const double one = value(claim.time_s - std::min(late, latest_s));
            const double next = value(claim.time_s - std::min(late + step_s, latest_s));
            if (claim.value >= std::min(one, next) - tolerance &&
                claim.value <= std::max(one, next) + tolerance) {
                return true;
            }
        }
        return false;
    }

    /// Of all faults at that time: one delays what another has delayed.
    template <class Length>
    double sum(std::int64_t true_ns, Length length) const {
        double result = 0;
        for (const PlacedFault& placed : faults_) {
            result += placed.covers(true_ns) ? length(*placed.fault) : 0;
        }
        return result;
    }

    /// How far the joint's limits allow a single position to be off that follows right readings: for the time
    /// since the last right one, at least a period and at most `max_age`.
    [[nodiscard]] double within_limits(std::size_t joint, const Claim& claim) const {
        const auto time_ns = static_cast<std::int64_t>(1e9 * claim.time_s);
        const JointSight::Blind blind = sight_[joint].blind_at(time_ns);
        return blind.blind_ns == 0
                   ? 0
                   : reach_rad(joint, truth_.velocity(joint, claim.time_s),
                               std::clamp(blind.blind_ns, bus_period, bus_max_age), blind.span_ns);
    }

    /// Whether a reading is of a run that begins after more than `max_age` without a right reading, where the
    /// limits allow the joint to be by then, and not at the device's zero. Such a run looks like a joint
    /// that went there meanwhile, however far off it is later.
    [[nodiscard]] bool after_silence(std::size_t joint, const JointSight::Shown& shown) const {
        const JointSight::Run& run = sight_[joint].run(shown.run);
        const double reach = reach_rad(joint, run.velocity, run.blind_ns, 3 * bus_period);
        return run.blind_ns > bus_max_age && !run.at_zero && std::abs(run.error_rad) <= reach;
    }

    /// Whether the readings that count have this value around its instant, as late as frames may be.
    template <class Counts>
    [[nodiscard]] bool is_shown(std::size_t joint, double JointSight::Shown::*what, const Claim& claim,
                                double tolerance, Counts counts) const {
        const auto time_ns = static_cast<std::int64_t>(1e9 * claim.time_s);
        const auto unknown_ns = static_cast<std::int64_t>(1e9 * claim.unknown_s);
        return sight_[joint].shows(what, claim.value, tolerance, time_ns - unknown_ns - bus_jitter,
                                   time_ns + bus_jitter, counts);
    }

    /// Whether an effort comes in frames with a position that is wrong or undecidable, as it is there.
    [[nodiscard]] bool of_undecidable_joint(std::size_t joint, const Claim& claim, double tolerance) const {
        return is_shown(
            joint, &JointSight::Shown::effort, claim, tolerance,
            [&](const JointSight::Shown& shown) { return !shown.right || after_silence(joint, shown); });
    }

    /// How far the limits allow a joint to be from where it is: what it can do for so long after its last
    /// right readings, which show its velocity over `span_ns` only so well.
    [[nodiscard]] double reach_rad(std::size_t joint, double velocity, std::int64_t blind_ns,
                                   std::int64_t span_ns) const {
        const double jitter_s = seconds_of(bus_track_jitter);
        const double age_s = seconds_of(blind_ns) + 2 * jitter_s;
        const double span_s = seconds_of(span_ns);
        const double fastest = std::abs(velocity) + limits_.acceleration * (age_s + span_s);
        const double reading = arm_.step_rad[joint] + fastest * jitter_s;
        const double speed =
            span_ns > 0 ? 2 * reading / span_s + 0.5 * limits_.acceleration * span_s : limits_.velocity;
        const double off = reading + speed * age_s + 0.5 * limits_.acceleration * age_s * age_s;
        const double most = (limits_.velocity + std::abs(velocity)) * age_s + 2 * arm_.step_rad[joint];
        return std::min(off, most); // of two joints that leave with all their speed
    }

    /// Ten times what wrenches are usually off their line, by noise and lateness, and what else the gate
    /// allows.
    [[nodiscard]] double below_jumps() const {
        const double usual = 2 * noise() + Truth::load_rate * arm_.output_range * seconds_of(bus_jitter);
        return 10 * usual + 0.005 * 0.2 * arm_.output_range;
    }

    const CampaignArm& arm_;
    const Truth& truth_;
    hal::MotionLimits limits_;
    std::span<const PlacedFault> faults_;
    std::span<const JointSight> sight_; ///< joint by joint
};

} // namespace dfdyn::tests
