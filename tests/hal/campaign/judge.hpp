// SPDX-License-Identifier: Apache-2.0
// What is right: the encoder's or sensor's resolution and the true motion decide, nothing else.
#pragma once

#include "tests/hal/campaign/faults.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace dfdyn::tests {

/// A fault in its place.
struct PlacedFault {
    const Fault* fault;
    std::int64_t begin_ns, end_ns;

    [[nodiscard]] bool covers(std::int64_t time_ns) const {
        const auto recovery_ns = static_cast<std::int64_t>(1e9 * fault->recovery_s);
        return time_ns >= begin_ns - 5 * bus_period && time_ns <= end_ns + recovery_ns;
    }
};

/// How an accepted value compares with the truth.
enum class Match {
    wrong,
    unseen, ///< off, by no more than the limits of the joint or of the sensor's gate can show
    right   ///< as the device measured it, or on the line between two measurements
};

/// A value that was accepted for an instant, and how long before it was measured if it is held.
struct Claim {
    double value;
    double time_s;    ///< by a clock whose error is known,
    double unknown_s; ///< or up to so much earlier
    hal::ValueOrigin origin;
};

/// Compares the values of one kind of arm with the truth.
template <class Arm>
class Judge {
  public:
    Judge(const Truth& truth, const hal::MotionLimits& limits, std::span<const PlacedFault> faults)
        : truth_(truth), limits_(limits), faults_(faults) {}

    /// Position of a joint; `true_ns`: when it was assembled.
    [[nodiscard]] Match position(std::size_t joint, const Claim& claim, std::int64_t true_ns) const {
        const auto truth = [&](double time_s) { return truth_.position(joint, time_s); };
        const double counts = 0.5 * Arm::step + 1e-7; // a float has no more
        const double tolerance = counts + chord(Truth::most_acceleration, claim.origin);
        const double waited_s = longest(true_ns, [](const Fault& fault) { return fault.waits_s; });
        if (is_near(truth, claim, waited_s, 0, tolerance)) {
            return Match::right;
        }
        const bool altered = std::ranges::any_of(faults_, [&](const PlacedFault& placed) {
            return placed.fault->alters_positions && placed.covers(true_ns);
        });
        const double unseen = unseen_rad(truth_.velocity(joint, claim.time_s));
        return altered && is_near(truth, claim, waited_s, 0, tolerance + unseen) ? Match::unseen
                                                                                 : Match::wrong;
    }

    /// Channel of the wrench, or effort of a joint.
    [[nodiscard]] Match output(std::size_t channel, const Claim& claim, std::int64_t true_ns) const {
        const auto truth = [&](double time_s) {
            return Arm::efforts ? truth_.effort(channel, time_s)
                                : Arm::output_range * truth_.load(channel, time_s);
        };
        const double bend = Arm::efforts ? Truth::effort_bend : Arm::output_range * Truth::load_bend;
        const double tolerance = noise() + chord(bend, claim.origin);
        const double waited_s = longest(true_ns, [](const Fault& fault) { return fault.waits_s; });
        if (is_near(truth, claim, waited_s, 0, tolerance)) {
            return Match::right;
        }
        const double late_s = longest(true_ns, [](const Fault& fault) { return fault.late_s; });
        const double early_s = longest(true_ns, [](const Fault& fault) { return fault.early_s; });
        const bool corrupted = !Arm::efforts && std::ranges::any_of(faults_, [&](const PlacedFault& placed) {
            return placed.fault->alters_outputs && placed.covers(true_ns);
        });
        const double unseen = corrupted ? unseen_output() : 0;
        return is_near(truth, claim, waited_s + late_s, early_s, tolerance + unseen) ? Match::unseen
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
    static double noise() { return 2.5 * (Arm::efforts ? 1e-3 : Arm::output_range / 32768) + 1e-6; }

    /// Whether the truth was near the value at its instant or before, by the lateness of its frames.
    template <class Value>
    static bool is_near(Value value, const Claim& claim, double late_s, double early_s, double tolerance) {
        constexpr double step_s = 0.5e-3; // the truth is straight for so long, to a fraction of the tolerance
        const double latest_s = (Arm::synchronous ? 0 : seconds_of(bus_jitter)) + claim.unknown_s + late_s;
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

    template <class Length>
    double longest(std::int64_t true_ns, Length length) const {
        double result = 0;
        for (const PlacedFault& placed : faults_) {
            result = placed.covers(true_ns) ? std::max(result, length(*placed.fault)) : result;
        }
        return result;
    }

    /// How far the limits allow a joint to be from where it is: what it can do from the last trusted reading
    /// on, `max_age` and the jitter before, whose readings show the velocity over three periods only so well.
    double unseen_rad(double velocity) const {
        const double jitter_s = seconds_of(bus_track_jitter);
        const double age_s = seconds_of(bus_max_age) + 2 * jitter_s;
        const double span_s = 3 * seconds_of(bus_period);
        const double fastest = std::abs(velocity) + limits_.acceleration * (age_s + span_s);
        const double reading = Arm::step + fastest * jitter_s;
        const double speed = 2 * reading / span_s + 0.5 * limits_.acceleration * span_s;
        return reading + speed * age_s + 0.5 * limits_.acceleration * age_s * age_s;
    }

    /// Ten times what wrenches are usually off their line, by noise and lateness, and what else the gate
    /// allows.
    static double unseen_output() {
        const double usual = 2 * noise() + Truth::load_rate * Arm::output_range * seconds_of(bus_jitter);
        return 10 * usual + 0.005 * 0.2 * Arm::output_range;
    }

    const Truth& truth_;
    hal::MotionLimits limits_;
    std::span<const PlacedFault> faults_;
};

} // namespace dfdyn::tests
