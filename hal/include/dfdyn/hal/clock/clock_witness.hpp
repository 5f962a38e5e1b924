// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <optional>

namespace dfdyn::hal {

/// Knows which frames show the clock of the devices' stamps. A controller that stamps what it receives may
/// stamp neither its error frames nor what this program sends: those have the operating system's clock, which
/// may be seconds off. They show nothing then. O(1).
class ClockWitness {
  public:
    /// Accepts a frame, and returns whether its stamp is of the clock of the devices' last frame; true before
    /// the first of those.
    constexpr bool shows_clock(const Frame& frame) noexcept {
        const bool of_device = !frame.error && frame.origin != Origin::this_socket;
        source_ = of_device ? frame.stamp_source : source_;
        return !source_ || source_ == frame.stamp_source;
    }

  private:
    std::optional<StampSource> source_; ///< of the devices' stamps
};

} // namespace dfdyn::hal
