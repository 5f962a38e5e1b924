// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/history.hpp"
#include "dfdyn/hal/gate/gap.hpp"
#include "dfdyn/hal/gate/range.hpp"
#include "dfdyn/hal/gate/staleness.hpp"
#include "dfdyn/hal/motion/startup.hpp"

namespace dfdyn::hal {

struct TrackConfig {
    std::int64_t max_age_ns; ///< largest age of a held value; consecutive values further apart are a gap
    std::int64_t latency_ns; ///< from the measurement to the stamp of its frame
    StartupGate::Config qualification;
    std::int64_t period_ns = 0; ///< of the source; 0: unknown, so that no value is ever missing
    std::int64_t jitter_ns = 0; ///< largest difference between the delays of two frames
};

/// Origin of the value at a sample time.
enum class ValueOrigin : std::uint8_t {
    none,
    measured,     ///< at exactly this time
    interpolated, ///< between two consecutive measurements
    bridged,      ///< between two measurements with a missing one between them
    held          ///< from the last measurement, because the next one is not due yet
};

/// Names of the reasons, which differ between positions and outputs.
struct TrackReasons {
    Reason waiting;
    Reason stale;
    Reason missing;
    Reason gap;
    Reason out_of_range;
};
inline constexpr TrackReasons position_reasons{Reason::waiting_for_position, Reason::position_stale,
                                               Reason::position_missing, Reason::position_gap,
                                               Reason::position_out_of_range};
inline constexpr TrackReasons output_reasons{Reason::waiting_for_output, Reason::output_stale,
                                             Reason::output_missing, Reason::output_gap,
                                             Reason::output_out_of_range};

/// The checked recent values of one source (position, effort or wrench), and its value at any time in this
/// history.
///
/// A value that was due and has not come is missing. It is never replaced by the one before. There is no
/// value until the next one comes; then it is interpolated if the two are at most `max_age` apart. If the
/// next value is not due yet, the last one is held, at most for nine eighths of a period and the jitter. So
/// a closed loop that requests the newest time gets a value without waiting.
template <int values, int capacity>
class Track {
  public:
    using Values = typename RangeGate<values>::Values;
    using Ranges = typename RangeGate<values>::Ranges;

    constexpr Track(const TrackConfig& config, const Ranges& ranges, const TrackReasons& reasons) noexcept
        : latency_ns_(config.latency_ns), period_ns_(config.period_ns), jitter_ns_(config.jitter_ns),
          reasons_(reasons), staleness_(config.max_age_ns), gap_(config.max_age_ns), range_(ranges),
          qualification_(config.qualification) {}

    /// Takes a reading. `zero`: its raw values are all 0. A reading with a reason is stored without a value.
    /// A reading that is not later than the last is counted and otherwise ignored. Two different values with
    /// one stamp are both invalid, because one has a wrong stamp or sender.
    constexpr void push(std::int64_t stamp_ns, Reason reason, const Values& value, bool zero) noexcept {
        Measurement<values> entry{stamp_ns - latency_ns_, reason, value};
        if (overtaken(entry)) {
            return;
        }
        if (gap_.ends(entry.stamp_ns)) {
            qualification_.restart();
        }
        if (entry.reason == Reason::ok && !range_.within(value)) {
            entry.reason = reasons_.out_of_range;
        }
        if (entry.reason == Reason::ok && !qualification_.qualified(zero)) {
            entry.reason = Reason::qualifying;
        }
        history_.push(entry);
    }

    /// Returns true if a reading with this stamp is later than the last.
    [[nodiscard]] constexpr bool is_later(std::int64_t stamp_ns) const noexcept {
        return history_.empty() || stamp_ns - latency_ns_ > history_.newest().stamp_ns;
    }

    /// Requires the source to qualify again, after a fault.
    constexpr void disqualify() noexcept { qualification_.restart(); }

    /// Returns the values at a time, from the measurements until `now_ns`; see the class. `stamp_ns` of the
    /// result is the stamp of the newest measurement used. O(capacity).
    constexpr Measurement<values> at(std::int64_t instant_ns, std::int64_t now_ns) noexcept {
        const auto [before, after] = history_.around(instant_ns);
        Measurement<values> result;
        result.reason = usable(before, after, instant_ns, now_ns);
        if (result.reason == reasons_.stale) {
            staleness_.stale(before->stamp_ns, instant_ns);
        }
        if (result.reason != Reason::ok) {
            return result;
        }
        const bool between = after != nullptr && instant_ns > before->stamp_ns;
        result = between ? interpolate(*before, *after, instant_ns) : *before;
        result.stamp_ns = between ? after->stamp_ns : before->stamp_ns;
        return result;
    }

    /// Returns the origin of the result of `at`, if that is valid. O(capacity).
    [[nodiscard]] constexpr ValueOrigin origin(std::int64_t instant_ns) const noexcept {
        const auto [before, after] = history_.around(instant_ns);
        if (before == nullptr) {
            return ValueOrigin::none;
        }
        if (instant_ns == before->stamp_ns) {
            return ValueOrigin::measured;
        }
        if (after == nullptr) {
            return ValueOrigin::held;
        }
        const bool bridged =
            period_ns_ > 0 && after->stamp_ns - before->stamp_ns > period_ns_ + period_ns_ / 2 + jitter_ns_;
        return bridged ? ValueOrigin::bridged : ValueOrigin::interpolated;
    }

    /// Returns true if the value at this time is missing and may still be interpolated.
    [[nodiscard]] constexpr bool pending(std::int64_t instant_ns, std::int64_t now_ns) const noexcept {
        const auto [before, after] = history_.around(instant_ns);
        return before != nullptr && after == nullptr && before->reason == Reason::ok &&
               usable(before, after, instant_ns, now_ns) == reasons_.missing &&
               now_ns - latency_ns_ - before->stamp_ns <= staleness_.max_age_ns() + period_ns_;
    }

    /// Return true if a measurement exists, and the time of the newest one.
    [[nodiscard]] constexpr bool heard() const noexcept { return !history_.empty(); }
    [[nodiscard]] constexpr std::int64_t newest_ns() const noexcept { return history_.newest().stamp_ns; }

    [[nodiscard]] constexpr std::int64_t period_ns() const noexcept { return period_ns_; }
    [[nodiscard]] constexpr const StalenessGate& staleness() const noexcept { return staleness_; }
    [[nodiscard]] constexpr const GapGate& gap() const noexcept { return gap_; }
    [[nodiscard]] constexpr const RangeGate<values>& range() const noexcept { return range_; }
    [[nodiscard]] constexpr const StartupGate& qualification() const noexcept { return qualification_; }

    /// Returns the number of readings with a stamp not later than the last.
    [[nodiscard]] constexpr std::uint64_t not_later() const noexcept { return not_later_; }

  private:
    using Entry = Measurement<values>;

    constexpr bool overtaken(const Entry& entry) noexcept {
        if (history_.empty() || entry.stamp_ns > history_.newest().stamp_ns) {
            return false;
        }
        ++not_later_;
        const Entry& newest = history_.newest();
        if (entry.stamp_ns == newest.stamp_ns && newest.reason == Reason::ok && entry.value != newest.value) {
            history_.spoil_newest(Reason::time_not_increasing);
        }
        return true;
    }

    /// Returns true if the value after the one at `before_ns` was due, by now or by the sample time.
    [[nodiscard]] constexpr bool is_missing(std::int64_t before_ns, std::int64_t instant_ns,
                                            std::int64_t now_ns) const noexcept {
        const std::int64_t due_ns = before_ns + period_ns_ + period_ns_ / 8 + jitter_ns_;
        return period_ns_ > 0 && (instant_ns > due_ns || now_ns - latency_ns_ > due_ns);
    }

    [[nodiscard]] constexpr Reason usable(const Entry* before, const Entry* after, std::int64_t instant_ns,
                                          std::int64_t now_ns) const noexcept {
        if (before == nullptr) {
            return after == nullptr ? reasons_.waiting : Reason::history_too_short;
        }
        if (instant_ns == before->stamp_ns) {
            return before->reason;
        }
        if (after == nullptr) {
            if (instant_ns - before->stamp_ns > staleness_.max_age_ns()) {
                return reasons_.stale;
            }
            const bool missing =
                before->reason == Reason::ok && is_missing(before->stamp_ns, instant_ns, now_ns);
            return missing ? reasons_.missing : before->reason;
        }
        if (before->reason != Reason::ok) {
            return before->reason;
        }
        return gap_.between(before->stamp_ns, after->stamp_ns) ? reasons_.gap : after->reason;
    }

    std::int64_t latency_ns_;
    std::int64_t period_ns_;
    std::int64_t jitter_ns_;
    TrackReasons reasons_;
    StalenessGate staleness_;
    GapGate gap_;
    RangeGate<values> range_;
    StartupGate qualification_;
    History<values, capacity> history_;
    std::uint64_t not_later_ = 0;
};

} // namespace dfdyn::hal
