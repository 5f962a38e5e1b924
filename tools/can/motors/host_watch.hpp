// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/motor_command.hpp"
#include "tools/can/description/bus_finding.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Counts the commands of other programs to a motor. A bus check itself sends nothing.
class HostWatch {
  public:
    /// `only_torque`: a control command without stiffness and damping.
    void take(hal::MotorCommand command, bool only_torque) noexcept;
    /// Counts an answer to another host than the described one.
    void answered_other_host() noexcept { ++other_host_; }

    std::uint64_t count(hal::MotorCommand command) const noexcept {
        return counts_[static_cast<std::size_t>(command)];
    }

    /// Findings that endanger the motor or its values. `motor`: its name in messages.
    std::vector<BusFinding> findings(const std::string& motor) const;
    /// Summary of the commands, such as `12 commands, 3 polls`; empty: none.
    std::string summary() const;

  private:
    std::array<std::uint64_t, hal::motor_command_count> counts_{};
    std::uint64_t changes_ = 0; ///< between commands with and without stiffness or damping
    bool only_torque_ = false;
    std::uint64_t other_host_ = 0;
};

} // namespace dfdyn::tools
