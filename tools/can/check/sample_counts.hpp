// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/reason.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace dfdyn::tools {

/// Counts assembled samples by the reasons of their positions and outputs. Unlike hal::AssemblyCounters it
/// also counts the outputs of samples without positions.
class SampleCounts {
  public:
    /// Counts a sample. A common reason of its positions and its output counts once.
    void add(hal::Reason position, hal::Reason output) {
        ++total_;
        last_position_ = position;
        last_output_ = output;
        ++counts_.at(static_cast<std::size_t>(position));
        if (output != position) {
            ++counts_.at(static_cast<std::size_t>(output));
        }
    }

    /// Returns the number of samples.
    std::uint64_t total() const noexcept { return total_; }
    /// Returns the number of samples with this reason.
    std::uint64_t count(hal::Reason reason) const { return counts_.at(static_cast<std::size_t>(reason)); }
    /// Returns true if the last sample has this reason.
    bool last_has(hal::Reason reason) const noexcept {
        return total_ > 0 && (last_position_ == reason || last_output_ == reason);
    }

  private:
    std::uint64_t total_ = 0;
    std::array<std::uint64_t, hal::reason_count> counts_{};
    hal::Reason last_position_ = hal::Reason::ok, last_output_ = hal::Reason::ok;
};

} // namespace dfdyn::tools
