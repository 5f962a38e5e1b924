// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/history.hpp"
#include "dfdyn/hal/gate/gap.hpp"
#include "dfdyn/hal/gate/range.hpp"
#include "dfdyn/hal/gate/staleness.hpp"
#include "dfdyn/hal/motion/startup.hpp"

namespace dfdyn::hal {

struct TrackConfig {
    std::int64_t max_age_ns; ///< for how long a value is held; neighbours further apart are a gap
    std::int64_t latency_ns; ///< from the measurement to the stamp of its frame
    StartupGate::Config qualification;
    std::int64_t period_ns = 0; ///< in which a source sends; 0: not known, so that nothing is ever missing
    std::int64_t jitter_ns = 0; ///< largest difference of the lateness of two frames
};

/// How the value of an instant came about.
enum class ValueOrigin : std::uint8_t {
    none,
    measured,     ///< at this very instant
    interpolated, ///< between two consecutive measurements
    bridged,      ///< between two measurements that have a missing one between them
    held          ///< from the last measurement, because the next is not due yet
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

/// The recent past of one source (a joint's position, its effort, a wrench), gated, and its value at any
/// instant in it.
///
/// A value that was due and has not come is missing. It is never replaced by the one before: it is refused
/// until the next one comes, and then interpolated if the two are at most `max_age` apart. A value that is
/// not due yet is held from the last one, for at most a period and the jitter; a closed loop that asks for
/// the newest instant so gets one without waiting.
template <int values, int capacity>
class Track {
  public:
    using Values = typename RangeGate<values>::Values;
    using Ranges = typename RangeGate<values>::Ranges;

    constexpr Track(const TrackConfig& config, const Ranges& ranges, const TrackReasons& reasons) noexcept
        : latency_ns_(config.latency_ns), period_ns_(config.period_ns), jitter_ns_(config.jitter_ns),
          reasons_(reasons), staleness_(config.max_age_ns), gap_(config.max_age_ns), range_(ranges),
          qualification_(config.qualification) {}

    /// Takes a reading. `zero`: its raw values are all 0. A reading with a reason is kept as a hole. One that
    /// is not later than the last is counted and changes nothing; but two different ones of one instant make
    /// a hole of both, because one of them is of another instant, or of another sender.
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

    /// Whether a reading with this stamp is later than the last.
    [[nodiscard]] constexpr bool is_later(std::int64_t stamp_ns) const noexcept {
        return history_.empty() || stamp_ns - latency_ns_ > history_.newest().stamp_ns;
    }

    /// The source is not itself: it must qualify again.
    constexpr void disqualify() noexcept { qualification_.restart(); }

    /// Returns the values at an instant from the measurements until `now_ns`; see the class. `stamp_ns` is
    /// the stamp of the newest measurement used. O(capacity).
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

    /// How `at` came about where it has no reason. O(capacity).
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

    /// Whether the value of this instant is missing and may yet be interpolated.
    [[nodiscard]] constexpr bool pending(std::int64_t instant_ns, std::int64_t now_ns) const noexcept {
        const auto [before, after] = history_.around(instant_ns);
        return before != nullptr && after == nullptr && before->reason == Reason::ok &&
               usable(before, after, instant_ns, now_ns) == reasons_.missing &&
               now_ns - latency_ns_ - before->stamp_ns <= staleness_.max_age_ns() + period_ns_;
    }

    /// Whether anything has come, and when the newest of it was measured.
    [[nodiscard]] constexpr bool heard() const noexcept { return !history_.empty(); }
    [[nodiscard]] constexpr std::int64_t newest_ns() const noexcept { return history_.newest().stamp_ns; }

    [[nodiscard]] constexpr std::int64_t period_ns() const noexcept { return period_ns_; }
    [[nodiscard]] constexpr const StalenessGate& staleness() const noexcept { return staleness_; }
    [[nodiscard]] constexpr const GapGate& gap() const noexcept { return gap_; }
    [[nodiscard]] constexpr const RangeGate<values>& range() const noexcept { return range_; }
    [[nodiscard]] constexpr const StartupGate& qualification() const noexcept { return qualification_; }

    /// Readings that came with a stamp not later than the last.
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

    /// Whether the value after the one at `before_ns` was due: by now, and at the instant.
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
