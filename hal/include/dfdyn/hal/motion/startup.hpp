// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Refuses a source until it has sent enough readings. Encoders send well-formed zeros before they have their
/// position. So zeros do not count, unless there are very many: then the joint is at rest at zero.
class StartupGate {
  public:
    struct Config {
        int readings = 10;        ///< that are not zero
        int zero_readings = 1000; ///< in a row, which are believed
    };

    explicit constexpr StartupGate(const Config& config) noexcept : config_(config) {}

    /// Takes a reading; whether the source may be used with it. `zero`: its raw values are all 0.
    constexpr bool qualified(bool zero) noexcept {
        zeros_ = zero ? std::min(zeros_ + 1, config_.zero_readings) : 0;
        readings_ = std::min(readings_ + (zero ? 0 : 1), config_.readings);
        if (zeros_ == config_.zero_readings) {
            readings_ = config_.readings;
        }
        return readings_ == config_.readings;
    }

    /// The source was silent, or not itself: it must qualify again.
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
