// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"
#include "dfdyn/hal/reason.hpp"

#include <cstdint>

namespace dfdyn::hal {

/// Count of the frames that should not be on the bus, and the first of them, for a person to find. Used for
/// identifiers without a device, and for frames that a decoder rejects.
class UnexpectedFrames {
  public:
    struct Entry {
        std::uint32_t id = 0;
        bool extended = false;
        std::uint8_t length = 0;
        std::int64_t stamp_ns = 0;
        Reason reason = Reason::ok;
    };

    constexpr void add(const Frame& frame, Reason reason) noexcept {
        if (count_ == 0) {
            first_ = {frame.id, frame.extended, frame.length, frame.stamp_ns, reason};
        }
        ++count_;
    }

    [[nodiscard]] constexpr std::uint64_t count() const noexcept { return count_; }

    /// Returns the first one; valid while `count()` is not 0.
    [[nodiscard]] constexpr const Entry& first() const noexcept { return first_; }

  private:
    std::uint64_t count_ = 0;
    Entry first_;
};

} // namespace dfdyn::hal
