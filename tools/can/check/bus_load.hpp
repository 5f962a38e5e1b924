// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dfdyn::tools {

/// Load of a bus: the share of its bit rate that its frames use, with worst-case bit stuffing. All shares are
/// 0 if the bit rate is unknown.
class BusLoad {
  public:
    /// `bit_rate` in bit/s; 0: unknown.
    explicit BusLoad(double bit_rate = 0) noexcept : bit_rate_(bit_rate) {}

    /// Adds the bits per second of a described source.
    void expect(double bits_per_s) noexcept { expected_bits_per_s_ += bits_per_s; }
    /// Adds the bits of a frame to the mean.
    void count(double bits) noexcept { bits_ += bits; }
    /// Adds the bits of a frame, `time_ns` after the start, to the busiest windows of time.
    void watch(std::int64_t time_ns, double bits, bool is_known) noexcept;

    double bit_rate() const noexcept { return bit_rate_; } ///< 0: unknown
    /// Returns the mean load over `duration_s`.
    double mean(double duration_s) const noexcept {
        return duration_s > 0 && bit_rate_ > 0 ? bits_ / duration_s / bit_rate_ : 0;
    }
    /// Returns the load of the described sources.
    double expected() const noexcept { return bit_rate_ > 0 ? expected_bits_per_s_ / bit_rate_ : 0; }
    /// Largest load in 0.2 s, and largest load of undescribed identifiers in 0.2 s.
    double peak() const noexcept { return peak_.all; }
    double peak_unknown() const noexcept { return peak_.unknown; }

  private:
    struct Share {
        double all = 0, unknown = 0;
    };

    double bit_rate_;
    double expected_bits_per_s_ = 0;
    double bits_ = 0;
    Share peak_; ///< of all windows
    /// Bits of the current half window, and of the one before.
    Share half_bits_, half_before_;
    std::int64_t half_ = -1; ///< number of the current half window
};

} // namespace dfdyn::tools
