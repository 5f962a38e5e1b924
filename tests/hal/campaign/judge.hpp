// SPDX-License-Identifier: Apache-2.0
// Reference decision: depends only on the true motion and on the resolution of encoder or sensor.
#pragma once

#include "tests/hal/campaign/sight.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace dfdyn::tests {

/// A fault at its time.
struct PlacedFault {
    const Fault* fault;
    std::int64_t begin_ns, end_ns;
    std::int64_t recovered_ns; ///< end of its recovery, and of those pending when it began

    [[nodiscard]] bool covers(std::int64_t time_ns) const {
        return time_ns >= begin_ns - 5 * bus_period && time_ns <= recovered_ns;
    }
};

/// Result of the comparison of an accepted value with the truth.
enum class Match {
    wrong,
    undecidable, ///< wrong, but no receiver can detect it: docs/reference/faults.md
    right        ///< as measured by the device, or on the line between two measurements
};

/// An accepted value with its measurement time.
struct Claim {
    double value;
    double time_s;    ///< by a clock whose error is known
    double unknown_s; ///< possible additional age
    hal::ValueOrigin origin;
};

/// Compares the values of one arm with the truth. A frame that is `uninformative` does not end a time without
/// a correct reading, even if its position happens to be the true one. Zeros of a device without a position,
/// and repeated positions, contain no information.
class Judge {
  public:
    Judge(const CampaignArm& arm, const Truth& truth, const hal::MotionLimits& limits,
          std::span<const PlacedFault> faults, std::span<const JointSight> sight)
        : arm_(arm), truth_(truth), limits_(limits), faults_(faults), sight_(sight) {}

    /// Compares the position of a joint; `true_ns`: time of the assembly.
    [[nodiscard]] Match position(std::size_t joint, const Claim& claim, std::int64_t true_ns) const {
        const auto truth = [&](double time_s) { return truth_.position(joint, time_s); };
        const double counts = 0.5 * arm_.step_rad[joint] + 1e-7; // resolution of a float
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

    /// Returns the error of a position, and the largest undetectable error.
    [[nodiscard]] std::array<double, 2> explain(std::size_t joint, const Claim& claim) const {
        return {std::abs(claim.value - truth_.position(joint, claim.time_s)), within_limits(joint, claim)};
    }

    /// Compares a channel of the wrench, or the effort of a joint.
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
    /// Returns the largest deviation of a linear interpolation between two measurements.
    static double chord(double bend, hal::ValueOrigin origin) {
        const std::int64_t apart_ns = origin == hal::ValueOrigin::bridged ? bus_max_age
                                      : origin == hal::ValueOrigin::interpolated
                                          ? 3 * bus_period / 2 + bus_jitter
                                          : 0;
        return bend * seconds_of(apart_ns) * seconds_of(apart_ns) / 8;
    }

    /// Returns the devices' noise of two counts, with rounding.
    [[nodiscard]] double noise() const { return 2.5 * arm_.output_step + 1e-6; }

    /// Returns true if the truth was near the value at its time or before, within the delay of its frames.
    template <class Value>
    [[nodiscard]] bool is_near(Value value, const Claim& claim, double late_s, double early_s,
                               double tolerance) const {
        constexpr double step_s = 0.5e-3; // the truth is straight to a fraction of the tolerance
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

    /// Sums over all faults at that time, because delays add up.
    template <class Length>
    double sum(std::int64_t true_ns, Length length) const {
        double result = 0;
        for (const PlacedFault& placed : faults_) {
            result += placed.covers(true_ns) ? length(*placed.fault) : 0;
        }
        return result;
    }

    /// Returns the largest undetectable error of a single position after correct readings. It grows with the
    /// time since the last correct one, at least a period and at most `max_age`.
    [[nodiscard]] double within_limits(std::size_t joint, const Claim& claim) const {
        const auto time_ns = static_cast<std::int64_t>(1e9 * claim.time_s);
        const JointSight::Blind blind = sight_[joint].blind_at(time_ns);
        return blind.blind_ns == 0
                   ? 0
                   : reach_rad(joint, truth_.velocity(joint, claim.time_s),
                               std::clamp(blind.blind_ns, bus_period, bus_max_age), blind.span_ns);
    }

    /// Returns true if the reading's run begins after more than `max_age` without a correct reading, within
    /// the limits and not at the device's zero. A receiver assumes that the joint moved there, even if the
    /// error of the run grows later.
    [[nodiscard]] bool after_silence(std::size_t joint, const JointSight::Shown& shown) const {
        const JointSight::Run& run = sight_[joint].run(shown.run);
        const double reach = reach_rad(joint, run.velocity, run.blind_ns, 3 * bus_period);
        return run.blind_ns > bus_max_age && !run.at_zero && std::abs(run.error_rad) <= reach;
    }

    /// Returns true if the selected readings have this value around its time, within the delay of frames.
    template <class Counts>
    [[nodiscard]] bool is_shown(std::size_t joint, double JointSight::Shown::*what, const Claim& claim,
                                double tolerance, Counts counts) const {
        const auto time_ns = static_cast<std::int64_t>(1e9 * claim.time_s);
        const auto unknown_ns = static_cast<std::int64_t>(1e9 * claim.unknown_s);
        return sight_[joint].shows(what, claim.value, tolerance, time_ns - unknown_ns - bus_jitter,
                                   time_ns + bus_jitter, counts);
    }

    /// Returns true if the frames of an effort have a position that is wrong or undecidable.
    [[nodiscard]] bool of_undecidable_joint(std::size_t joint, const Claim& claim, double tolerance) const {
        return is_shown(
            joint, &JointSight::Shown::effort, claim, tolerance,
            [&](const JointSight::Shown& shown) { return !shown.right || after_silence(joint, shown); });
    }

    /// Returns the largest distance from the true position that the limits allow `blind_ns` after the last
    /// correct readings. Their span `span_ns` limits the accuracy of the known velocity.
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
        return std::min(off, most); // if true and assumed joint move apart at full speed
    }

    /// Ten times the usual deviation of wrenches from their line, by noise and delay, plus the minimum limit
    /// of the gate.
    [[nodiscard]] double below_jumps() const {
        const double usual = 2 * noise() + Truth::load_rate * arm_.output_range * seconds_of(bus_jitter);
        return 10 * usual + 0.005 * 0.2 * arm_.output_range;
    }

    const CampaignArm& arm_;
    const Truth& truth_;
    hal::MotionLimits limits_;
    std::span<const PlacedFault> faults_;
    std::span<const JointSight> sight_; ///< one per joint
};

} // namespace dfdyn::tests
