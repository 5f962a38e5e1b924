// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/motor_command.hpp"
#include "tools/can/description/bus_finding.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Phases of events in the intervals of a sequence of references. A program that sends both has nearly the
/// same phase each time.
class PhaseWatch {
  public:
    /// Begins the next interval.
    void take_reference(std::int64_t stamp_ns) noexcept;
    /// Only the first event of an interval counts.
    void take_event(std::int64_t stamp_ns) noexcept;
    /// Number of intervals with an event.
    std::uint64_t events() const noexcept { return events_; }
    /// Mean resultant length of the phases: 0 (spread evenly) to 1 (always the same).
    double concentration() const noexcept;

  private:
    std::optional<std::int64_t> reference_ns_, event_ns_;
    double sum_cos_ = 0, sum_sin_ = 0;
    std::uint64_t events_ = 0;
};

/// Counts the commands of other programs to a motor. A bus check itself sends nothing.
class HostWatch {
  public:
    /// `only_torque`: a control command without stiffness and damping.
    void take(hal::MotorCommand command, bool only_torque, std::int64_t stamp_ns) noexcept;
    /// Counts an answer to another host than the described one.
    void answered_other_host() noexcept { ++other_host_; }

    std::uint64_t count(hal::MotorCommand command) const noexcept {
        return counts_[static_cast<std::size_t>(command)];
    }

    /// Findings that endanger the motor or its values. `motor`: its name in messages. `needs_polls`: answers
    /// to commands have no position, so that the commanding program must poll, too.
    std::vector<BusFinding> findings(const std::string& motor, bool needs_polls = false) const;
    /// Summary of the commands, such as `12 commands, 3 polls`; empty: none.
    std::string summary() const;

  private:
    bool has_second_poller() const;

    std::array<std::uint64_t, hal::motor_command_count> counts_{};
    PhaseWatch polls_in_commands_, commands_in_polls_;
    std::uint64_t changes_ = 0; ///< between commands with and without stiffness or damping
    bool only_torque_ = false;
    std::uint64_t other_host_ = 0;
};

} // namespace dfdyn::tools
