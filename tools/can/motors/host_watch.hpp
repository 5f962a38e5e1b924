// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/motor_command.hpp"
#include "tools/can/description/bus_finding.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Counts what other programs command a motor: a check of a bus sends nothing itself.
class HostWatch {
  public:
    /// `only_torque`: a control command without stiffness and damping.
    void take(hal::MotorCommand command, bool only_torque) noexcept;
    /// Counts an answer for another host than the described one.
    void answered_other_host() noexcept { ++other_host_; }

    std::uint64_t count(hal::MotorCommand command) const noexcept {
        return counts_[static_cast<std::size_t>(command)];
    }

    /// What endangers the motor or its values. `motor`: as the messages name it.
    std::vector<BusFinding> findings(const std::string& motor) const;
    /// What was commanded, as `12 commands, 3 polls`; empty: nothing.
    std::string summary() const;

  private:
    std::array<std::uint64_t, hal::motor_command_count> counts_{};
    std::uint64_t changes_ = 0; ///< between commands with and without stiffness or damping
    bool only_torque_ = false;
    std::uint64_t other_host_ = 0;
};

} // namespace dfdyn::tools
