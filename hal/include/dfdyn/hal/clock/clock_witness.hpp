// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <optional>

namespace dfdyn::hal {

/// Selects the frames whose stamps come from the clock of the devices' stamps. Some controllers stamp neither
/// their error frames nor the frames that this program sends. These have the operating system's clock, which
/// may be seconds off, and are no evidence. O(1).
class ClockWitness {
  public:
    /// Takes a frame and returns true if its stamp has the same source as the last device's frame; true
    /// before the first such frame.
    constexpr bool shows_clock(const Frame& frame) noexcept {
        const bool of_device = !frame.error && frame.origin != Origin::this_socket;
        source_ = of_device ? frame.stamp_source : source_;
        return !source_ || source_ == frame.stamp_source;
    }

  private:
    std::optional<StampSource> source_; ///< source of the devices' stamps
};

} // namespace dfdyn::hal
