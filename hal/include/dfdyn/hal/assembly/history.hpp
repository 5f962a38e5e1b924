// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"
#include "dfdyn/hal/reason.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace dfdyn::hal {

/// Values measured at one time, or the reason why there are none.
template <int values>
struct Measurement {
    std::int64_t stamp_ns = 0;
    Reason reason = Reason::ok;
    std::array<double, static_cast<std::size_t>(values)> value{};
};

/// The last `capacity` measurements of a source, ordered by stamp.
template <int values, int capacity>
class History {
  public:
    using Entry = Measurement<values>;
    static_assert(capacity >= 2);

    /// Adds a measurement. Returns false and changes nothing if its stamp is not later than the newest.
    constexpr bool push(const Entry& entry) noexcept {
        if (filled_ > 0 && entry.stamp_ns <= newest().stamp_ns) {
            return false;
        }
        newest_ = (newest_ + 1) % ring_.size();
        ring_[newest_] = entry;
        filled_ = filled_ < capacity ? filled_ + 1 : capacity;
        return true;
    }

    [[nodiscard]] constexpr bool empty() const noexcept { return filled_ == 0; }

    /// Returns the newest measurement. Requires that it exists.
    [[nodiscard]] constexpr const Entry& newest() const noexcept { return ring_[newest_]; }

    /// Invalidates the newest measurement. Requires that it exists.
    constexpr void spoil_newest(Reason reason) noexcept { ring_[newest_].reason = reason; }

    /// The neighbours of a time: the last entry not later than it, and the first later one; null for none.
    /// O(capacity).
    struct Neighbours {
        const Entry* before = nullptr;
        const Entry* after = nullptr;
    };
    [[nodiscard]] constexpr Neighbours around(std::int64_t instant_ns) const noexcept {
        Neighbours found;
        for (int age = 0; age < filled_ && found.before == nullptr; ++age) {
            const Entry& entry =
                ring_[(newest_ + ring_.size() - static_cast<std::size_t>(age)) % ring_.size()];
            (entry.stamp_ns <= instant_ns ? found.before : found.after) = &entry;
        }
        return found;
    }

  private:
    std::array<Entry, static_cast<std::size_t>(capacity)> ring_{};
    std::size_t newest_ = 0;
    int filled_ = 0;
};

/// Interpolates linearly between two measurements. Their stamps must differ and enclose `instant_ns`.
template <int values>
[[nodiscard]] constexpr Measurement<values> interpolate(const Measurement<values>& before,
                                                        const Measurement<values>& after,
                                                        std::int64_t instant_ns) noexcept {
    const double part = static_cast<double>(instant_ns - before.stamp_ns) /
                        static_cast<double>(after.stamp_ns - before.stamp_ns);
    Measurement<values> result;
    result.stamp_ns = instant_ns;
    for (std::size_t i = 0; i < result.value.size(); ++i) {
        result.value[i] = before.value[i] + part * (after.value[i] - before.value[i]);
    }
    return result;
}

} // namespace dfdyn::hal
