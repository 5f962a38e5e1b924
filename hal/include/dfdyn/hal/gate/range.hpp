// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace dfdyn::hal {

/// Closed interval of the values of a joint or of a sensor's channel.
struct Range {
    double lowest;
    double highest;
};

/// Rejects values outside the sensor's range, and NaN.
template <int values>
class RangeGate {
  public:
    using Ranges = std::array<Range, static_cast<std::size_t>(values)>;
    using Values = std::array<double, static_cast<std::size_t>(values)>;

    explicit constexpr RangeGate(const Ranges& ranges) noexcept : ranges_(ranges) {}

    /// Returns true if all values are in range. Counts the sets that are not.
    constexpr bool within(const Values& value) noexcept {
        const bool all = contains(value);
        beyond_ += all ? 0U : 1U;
        return all;
    }

    [[nodiscard]] constexpr bool contains(const Values& value) const noexcept {
        bool all = true;
        for (std::size_t i = 0; i < value.size(); ++i) {
            all = all && value[i] >= ranges_[i].lowest && value[i] <= ranges_[i].highest;
        }
        return all;
    }

    [[nodiscard]] constexpr std::uint64_t count() const noexcept { return beyond_; }

  private:
    Ranges ranges_;
    std::uint64_t beyond_ = 0;
};

} // namespace dfdyn::hal
