// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Rejects a source until it has sent enough readings. Encoders send well-formed zeros before they have a
/// position. So zeros do not count, except a long run of them: then the joint is at rest at zero.
class StartupGate {
  public:
    struct Config {
        int readings = 10;        ///< required readings that are not zero
        int zero_readings = 1000; ///< consecutive zeros that are trusted
    };

    explicit constexpr StartupGate(const Config& config) noexcept : config_(config) {}

    /// Takes a reading and returns true if the source may be used. `zero`: all its raw values are 0.
    constexpr bool qualified(bool zero) noexcept {
        zeros_ = zero ? std::min(zeros_ + 1, config_.zero_readings) : 0;
        readings_ = std::min(readings_ + (zero ? 0 : 1), config_.readings);
        if (zeros_ == config_.zero_readings) {
            readings_ = config_.readings;
        }
        return readings_ == config_.readings;
    }

    /// Requires the source to qualify again, after a silence or a fault.
    constexpr void restart() noexcept {
        restarts_ += readings_ > 0 || zeros_ > 0 ? 1U : 0U;
        readings_ = 0;
        zeros_ = 0;
    }

    [[nodiscard]] constexpr std::uint64_t restarts() const noexcept { return restarts_; }

  private:
    Config config_;
    int readings_ = 0;
    int zeros_ = 0;
    std::uint64_t restarts_ = 0;
};

} // namespace dfdyn::hal
