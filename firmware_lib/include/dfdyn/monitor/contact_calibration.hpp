// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"
#include "dfdyn/monitor/contact_detector.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dfdyn {

/// Measures the limits of a ContactDetector during operation, with the motion and the learner for which it
/// will detect contacts. Nobody may touch the arm meanwhile.
///
/// The limits of a model belong to the recordings of its training. A loop that learns follows its reference
/// more accurately than the loop that recorded them, and its errors at starts and stops differ. In the first
/// half of the calibration the limits are `calibration_factor` times the model's, so that only a hard
/// collision is a contact. In the second half this is the largest factor, and the others are in proportion. A
/// second with a contact, or in which the detector settles, is discarded; it takes no time of the
/// calibration.
///
/// In the first half each limit, of a joint in a JointMotion, becomes the largest deviation; that of a motion
/// which did not occur has the joint's largest factor. In the second half all limits get a common factor, so
/// that the excess of all joints together reaches 1 `rate_per_hour` times per hour of motion: by an
/// exponential tail of the largest excesses of the seconds, with fewer than ten of them by the upper 90 %
/// confidence limit of its mean. No limit becomes smaller than the model's.
///
///     static ContactCalibration<float, 6> calibration({}, arm::contact_limits, 60, 0.1F);
///     static ContactDetector<float, 6> detector({}, calibration.limits());
///     ...
///     if (detector.tick(...)) { // or skip
///         calibration.abandon(); // if the motion does not continue after a contact
///     }
///     calibration.tick(sample.time_ns, detector);
///
/// No heap. Cost: a few comparisons per joint and tick, `peak_count` more once per second, and 30 per joint
/// twice. Memory: 15 numbers per joint.
template <class Scalar, int joints>
class ContactCalibration {
  public:
    using Detector = ContactDetector<Scalar, joints>; ///< whose limits are measured

    static constexpr Scalar calibration_factor = 10; ///< on the model's limits during the calibration
    static constexpr Scalar margin = Scalar(1.08);   ///< of the common factor, as in `dfdyn train`
    static constexpr int peak_count = 11;            ///< largest excesses that are kept

    /// `trained`: the model's limits, one per joint; kept by reference. `duration_s`: time with motion, 1 to
    /// 1e6 s; the arm's usual motion should repeat several times in each half. `rate_per_hour`: of false
    /// contacts, > 0.
    ContactCalibration(Extent<joints> count, const ContactLimits<Scalar>* trained, Scalar duration_s,
                       Scalar rate_per_hour) noexcept
        : count_(count), trained_(trained), joints_(Storage<Largest, joints>::zeros(count)),
          limits_(Storage<ContactLimits<Scalar>, joints>::zeros(count)),
          duration_ns_(static_cast<std::int64_t>(duration_s * Scalar(1e9))), rate_per_hour_(rate_per_hour) {
        std::copy_n(trained_, static_cast<int>(count_), limits_.begin());
        scale_limits(calibration_factor);
    }
    ContactCalibration(const ContactCalibration&) = delete; // the detector refers to the limits
    ContactCalibration& operator=(const ContactCalibration&) = delete;

    /// Returns the limits for the detector, one per joint. Their values change after each half.
    [[nodiscard]] const ContactLimits<Scalar>* limits() const noexcept { return limits_.data(); }

    /// Registers a tick of the detector at its stamp.
    void tick(std::int64_t time_ns, const Detector& detector) noexcept {
        if (time_ns == time_ns_) {
            return; // the detector ignores a repeated stamp, too
        }
        const std::int64_t step_ns = since_last(time_ns);
        time_ns_ = time_ns;
        // in the tick that ends a contact the deviations are still those of the contact
        const bool touched = touched_ || detector.contact();
        touched_ = detector.contact();
        if (!measuring()) {
            return;
        }
        if (touched || step_ns == 0 || !detector.settled()) {
            clear_second();
            return;
        }
        add(detector, step_ns);
        if (second_ns_ >= one_second_ns) {
            end_second();
        }
    }

    /// Ends the calibration with the model's limits.
    void abandon() noexcept {
        if (measuring()) {
            std::copy_n(trained_, static_cast<int>(count_), limits_.begin());
            phase_ = Phase::abandoned;
        }
    }

    /// Returns whether the limits are measured.
    [[nodiscard]] bool finished() const noexcept { return phase_ == Phase::finished; }
    /// Returns whether `abandon` ended the calibration.
    [[nodiscard]] bool abandoned() const noexcept { return phase_ == Phase::abandoned; }
    /// Returns whether the calibration has not ended.
    [[nodiscard]] bool measuring() const noexcept { return !finished() && !abandoned(); }
    /// Returns the missing time with motion, s.
    [[nodiscard]] Scalar remaining_s() const noexcept {
        return measuring() ? seconds(std::max(duration_ns_ - moved_ns_, std::int64_t{0})) : Scalar(0);
    }
    /// Returns the present limit of a joint relative to the model's, `joint` from 0.
    [[nodiscard]] Scalar factor(int joint, JointMotion motion) const noexcept {
        const int number = static_cast<int>(motion);
        return limits_[joint].limit[number] / trained_[joint].limit[number];
    }

  private:
    static constexpr std::int64_t one_second_ns = 1'000'000'000;
    static constexpr auto longest_gap_ns =
        static_cast<std::uint64_t>(Detector::longest_gap_s * Scalar(one_second_ns));

    enum class Phase : std::uint8_t { joint_limits, common_factor, finished, abandoned };

    /// Largest deviations of a joint for each JointMotion, relative to the model's limits.
    struct Largest {
        Scalar noted[joint_motion_count], now[joint_motion_count]; ///< in all seconds, and in this one
    };

    [[nodiscard]] static Scalar seconds(std::int64_t time_ns) noexcept {
        return static_cast<Scalar>(time_ns) * Scalar(1e-9);
    }

    /// Returns the time since the last stamp; 0 after a gap, or if this stamp is not later.
    [[nodiscard]] std::int64_t since_last(std::int64_t time_ns) const noexcept {
        const std::uint64_t step_ns =
            static_cast<std::uint64_t>(time_ns) - static_cast<std::uint64_t>(time_ns_);
        return time_ns > time_ns_ && step_ns <= longest_gap_ns ? static_cast<std::int64_t>(step_ns) : 0;
    }

    void add(const Detector& detector, std::int64_t step_ns) noexcept {
        bool moves = false;
        for (int k = 0; k < count_; ++k) {
            const JointMotion motion = detector.motion(k);
            moves = moves || motion != JointMotion::standing;
            Scalar& now = joints_[k].now[static_cast<int>(motion)];
            now = std::max(now, scale_ * detector.share(k));
        }
        excess_ = std::max(excess_, scale_ * detector.excess());
        second_ns_ += step_ns;
        second_moved_ns_ += moves ? step_ns : 0;
    }

    void clear_second() noexcept {
        for (Largest& joint : joints_) {
            std::fill_n(joint.now, joint_motion_count, Scalar(0));
        }
        excess_ = 0;
        second_ns_ = second_moved_ns_ = 0;
    }

    void end_second() noexcept {
        moved_ns_ += second_moved_ns_;
        if (phase_ == Phase::joint_limits) {
            for (Largest& joint : joints_) {
                std::transform(joint.now, joint.now + joint_motion_count, joint.noted, joint.noted,
                               [](Scalar now, Scalar noted) { return std::max(now, noted); });
            }
            if (moved_ns_ >= duration_ns_ / 2) {
                set_joint_limits();
                half_ns_ = moved_ns_;
                phase_ = Phase::common_factor;
            }
        } else {
            add_peak(excess_);
            if (moved_ns_ >= duration_ns_) {
                scale_limits(common_factor() / scale_);
                phase_ = Phase::finished;
            }
        }
        clear_second();
    }

    void scale_limits(Scalar factor) noexcept {
        for (ContactLimits<Scalar>& one : limits_) {
            for (Scalar& limit : one.limit) {
                limit *= factor;
            }
            one.relative *= factor;
        }
    }

    /// Sets the limits' proportions, still with a large common factor `scale_`. At standstill friction bears
    /// any torque up to the break-away torque: as in `dfdyn train` this limit is at least half the limit near
    /// a change of the motion.
    void set_joint_limits() noexcept {
        constexpr Scalar standing_share = Scalar(0.5);
        Scalar largest_factor = 1;
        for (int k = 0; k < count_; ++k) {
            const Scalar* const noted = joints_[k].noted;
            const Scalar largest = within_factors(*std::max_element(noted, noted + joint_motion_count));
            ContactLimits<Scalar>& one = limits_[k];
            one = trained_[k];
            for (int motion = 0; motion < joint_motion_count; ++motion) {
                one.limit[motion] *= noted[motion] > 0 ? within_factors(noted[motion]) : largest;
            }
            one.relative *= largest;
            one.limit[0] = std::max(one.limit[0], standing_share * one.limit[1]);
            largest_factor = std::max(largest_factor, largest);
        }
        scale_ = calibration_factor / largest_factor;
        scale_limits(scale_);
    }

    [[nodiscard]] static Scalar within_factors(Scalar factor) noexcept {
        return std::clamp(factor, Scalar(1), calibration_factor);
    }

    void add_peak(Scalar peak) noexcept {
        const int count = std::min(peaks_noted_, peak_count);
        Scalar* const position = std::upper_bound(peaks_, peaks_ + count, peak,
                                                  [](Scalar one, Scalar other) { return one > other; });
        if (position < peaks_ + peak_count) {
            std::copy_backward(position, peaks_ + std::min(count, peak_count - 1),
                               peaks_ + std::min(count + 1, peak_count));
            *position = peak;
        }
        ++peaks_noted_;
    }

    /// Returns the factor from the mean of `count` exponential values to the upper 90 % confidence limit of
    /// the mean (Wilson and Hilferty's approximation of chi-squared).
    [[nodiscard]] static Scalar upper_mean(int count) noexcept {
        constexpr Scalar normal_quantile = Scalar(-1.2816); // 10 %
        const Scalar part = 1 / (9 * static_cast<Scalar>(count));
        const Scalar root = 1 - part + normal_quantile * std::sqrt(part);
        return 1 / (root * root * root);
    }

    /// Returns the excess that is reached `rate_per_hour_` times, with `margin`, as a factor of the limits.
    [[nodiscard]] Scalar common_factor() const noexcept {
        const int tail = std::min(peaks_noted_ / 2, peak_count - 1);
        const Scalar threshold = peaks_[tail];
        Scalar excess = threshold;
        if (tail > 0) {
            Scalar mean = 0;
            for (int i = 0; i < tail; ++i) {
                mean += (peaks_[i] - threshold) / static_cast<Scalar>(tail);
            }
            mean *= tail < peak_count - 1 ? upper_mean(tail) : Scalar(1);
            constexpr Scalar hour_s = 3600;
            const Scalar per_hour = hour_s * static_cast<Scalar>(tail) / seconds(moved_ns_ - half_ns_);
            excess += mean * std::log(std::max(per_hour / rate_per_hour_, Scalar(1)));
        }
        return std::clamp(margin * excess, Scalar(1), scale_);
    }

    [[no_unique_address]] Extent<joints> count_;
    const ContactLimits<Scalar>* trained_;
    Storage<Largest, joints> joints_;
    Storage<ContactLimits<Scalar>, joints> limits_;
    std::int64_t time_ns_ = 0;
    std::int64_t duration_ns_;                         ///< of the calibration, with motion
    std::int64_t moved_ns_ = 0, half_ns_ = 0;          ///< time with motion: all, and in the first half
    std::int64_t second_ns_ = 0, second_moved_ns_ = 0; ///< in this second: all, and with motion
    Scalar rate_per_hour_;
    Scalar scale_ = calibration_factor; ///< of the limits, beside their proportions
    Scalar peaks_[peak_count]{};        ///< largest excesses of the second half, in descending order
    Scalar excess_ = 0;                 ///< largest one in this second
    int peaks_noted_ = 0;
    Phase phase_ = Phase::joint_limits;
    bool touched_ = false; ///< a contact in the last tick
};

} // namespace dfdyn
