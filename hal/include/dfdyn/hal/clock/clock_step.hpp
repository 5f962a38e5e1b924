// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace dfdyn::hal {

/// Detects clock steps that are too small for ClockGate. A clock step changes the interval of every source by
/// the same time at once. If only one source changes, its frames are late, lost or from another sender.
/// O(sources).
template <int sources>
class ClockStepWatch {
  public:
    /// Takes the stamp of a source that sends every `period_ns`, at most `jitter_ns` late. A source with the
    /// period 0, and a frame that is repeated with its stamp, are ignored.
    constexpr void take(int source, std::int64_t stamp_ns, std::int64_t period_ns,
                        std::int64_t jitter_ns) noexcept {
        Source& mine = source_[static_cast<std::size_t>(source)];
        if (period_ns <= 0 || (mine.heard && stamp_ns == mine.stamp_ns)) {
            return;
        }
        const std::int64_t step_ns = stamp_ns - mine.stamp_ns - period_ns;
        if (mine.heard && distance(step_ns, 0) > jitter_ns) {
            mine.step_ns = step_ns;
            mine.stepped_ns = stamp_ns;
            mine.stepped = true;
        }
        mine.stamp_ns = stamp_ns;
        mine.period_ns = period_ns;
        mine.heard = true;
    }

    /// Returns the step (ns) of the clock shortly before `now_ns`, if all sources show it to within
    /// `tolerance_ns`. For a source that lost frames meanwhile, one period for each of them is subtracted.
    [[nodiscard]] constexpr std::optional<std::int64_t> step_ns(std::int64_t now_ns,
                                                                std::int64_t tolerance_ns) const noexcept {
        std::optional<std::int64_t> least;
        for (const Source& one : source_) {
            const bool recent = one.stepped && distance(now_ns, one.stepped_ns) <= memory_ns;
            if (one.heard && !recent) {
                return std::nullopt;
            }
            if (one.heard) {
                least = std::min(least.value_or(one.step_ns), one.step_ns);
            }
        }
        for (const Source& one : source_) {
            const std::int64_t more_ns = one.step_ns - least.value_or(0);
            const std::int64_t periods = one.heard ? (more_ns + one.period_ns / 2) / one.period_ns : 0;
            if (one.heard &&
                (periods > max_lost_frames || distance(more_ns, periods * one.period_ns) > tolerance_ns)) {
                return std::nullopt;
            }
        }
        return least;
    }

    /// Returns the step modulo the period, in case that all sources lost the same number of frames.
    [[nodiscard]] static constexpr std::int64_t within_period(std::int64_t step_ns,
                                                              std::int64_t period_ns) noexcept {
        const std::int64_t rest_ns = step_ns % period_ns;
        return rest_ns > period_ns / 2    ? rest_ns - period_ns
               : rest_ns < -period_ns / 2 ? rest_ns + period_ns
                                          : rest_ns;
    }

  private:
    static constexpr std::int64_t memory_ns = 200'000'000;
    static constexpr int max_lost_frames = 3; ///< lost frames of a source

    struct Source {
        std::int64_t stamp_ns = 0; ///< stamp of its last frame
        std::int64_t period_ns = 0;
        std::int64_t step_ns = 0;    ///< difference between its last unusual interval and its period
        std::int64_t stepped_ns = 0; ///< end of that interval
        bool heard = false;
        bool stepped = false;
    };

    [[nodiscard]] static constexpr std::int64_t distance(std::int64_t a, std::int64_t b) noexcept {
        return a < b ? b - a : a - b;
    }

    std::array<Source, static_cast<std::size_t>(sources)> source_{};
};

} // namespace dfdyn::hal
