// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/history.hpp"
#include "dfdyn/hal/gate/gap.hpp"
#include "dfdyn/hal/gate/qualification.hpp"
#include "dfdyn/hal/gate/range.hpp"
#include "dfdyn/hal/gate/staleness.hpp"

namespace dfdyn::hal {

struct TrackConfig {
    std::int64_t max_age_ns; ///< for how long a value is held; neighbours further apart are a gap
    std::int64_t latency_ns; ///< from the measurement to the stamp of its frame
    QualificationGate::Config qualification;
};

/// What is missing or wrong is called differently for positions and outputs.
struct TrackReasons {
    Reason waiting;
    Reason stale;
    Reason gap;
    Reason out_of_range;
};
inline constexpr TrackReasons position_reasons{Reason::waiting_for_position, Reason::position_stale,
                                               Reason::position_gap, Reason::position_out_of_range};
inline constexpr TrackReasons output_reasons{Reason::waiting_for_output, Reason::output_stale,
                                             Reason::output_gap, Reason::output_out_of_range};

/// The recent past of one source (a joint's position, its effort, a wrench), gated, and its value at any
/// instant in it.
template <int values, int capacity>
class Track {
  public:
    using Values = typename RangeGate<values>::Values;
    using Ranges = typename RangeGate<values>::Ranges;

    constexpr Track(const TrackConfig& config, const Ranges& ranges, const TrackReasons& reasons) noexcept
        : latency_ns_(config.latency_ns), reasons_(reasons), staleness_(config.max_age_ns),
          gap_(config.max_age_ns), range_(ranges), qualification_(config.qualification) {}

    /// Takes a reading. `zero`: its raw values are all 0. A reading with a reason is kept as a hole; one that
    /// is not later than the last is counted and changes nothing.
    constexpr void push(std::int64_t stamp_ns, Reason reason, const Values& value, bool zero) noexcept {
        Measurement<values> entry{stamp_ns - latency_ns_, reason, value};
        if (!history_.empty() && entry.stamp_ns <= history_.newest().stamp_ns) {
            ++not_later_;
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

    /// The source is not itself (any more): it must qualify anew.
    constexpr void disqualify() noexcept { qualification_.restart(); }

    /// The values at an instant: interpolated between their neighbours; after the newest, that one, as long
    /// as it is not stale. `stamp_ns` is that of the newest measurement that takes part. O(capacity).
    constexpr Measurement<values> at(std::int64_t instant_ns) noexcept {
        const auto [before, after] = history_.around(instant_ns);
        Measurement<values> result;
        result.reason = usable(before, after, instant_ns);
        if (result.reason != Reason::ok) {
            return result;
        }
        const bool between = after != nullptr && instant_ns > before->stamp_ns;
        result = between ? interpolate(*before, *after, instant_ns) : *before;
        result.stamp_ns = between ? after->stamp_ns : before->stamp_ns;
        return result;
    }

    /// Whether anything has come, and when the newest of it was measured.
    [[nodiscard]] constexpr bool heard() const noexcept { return !history_.empty(); }
    [[nodiscard]] constexpr std::int64_t newest_ns() const noexcept { return history_.newest().stamp_ns; }

    [[nodiscard]] constexpr const StalenessGate& staleness() const noexcept { return staleness_; }
    [[nodiscard]] constexpr const GapGate& gap() const noexcept { return gap_; }
    [[nodiscard]] constexpr const RangeGate<values>& range() const noexcept { return range_; }
    [[nodiscard]] constexpr const QualificationGate& qualification() const noexcept { return qualification_; }

    /// Readings that came with a stamp not later than the last.
    [[nodiscard]] constexpr std::uint64_t not_later() const noexcept { return not_later_; }

  private:
    using Entry = Measurement<values>;

    constexpr Reason usable(const Entry* before, const Entry* after, std::int64_t instant_ns) noexcept {
        if (before == nullptr) {
            return after == nullptr ? reasons_.waiting : Reason::history_too_short;
        }
        if (after == nullptr) {
            return staleness_.stale(before->stamp_ns, instant_ns) ? reasons_.stale : before->reason;
        }
        if (before->reason != Reason::ok || instant_ns == before->stamp_ns) {
            return before->reason;
        }
        return gap_.between(before->stamp_ns, after->stamp_ns) ? reasons_.gap : after->reason;
    }

    std::int64_t latency_ns_;
    TrackReasons reasons_;
    StalenessGate staleness_;
    GapGate gap_;
    RangeGate<values> range_;
    QualificationGate qualification_;
    History<values, capacity> history_;
    std::uint64_t not_later_ = 0;
};

} // namespace dfdyn::hal
