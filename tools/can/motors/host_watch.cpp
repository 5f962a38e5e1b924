// SPDX-License-Identifier: Apache-2.0
#include "tools/can/motors/host_watch.hpp"

#include <cmath>
#include <numbers>

namespace dfdyn::tools {

namespace {

using hal::MotorCommand;

constexpr std::uint64_t repeated = 5;   ///< fewer may be commands of a person
constexpr double share_of_two = 0.05;   ///< of all commands; a smaller share may be the start of one program
constexpr double of_one_program = 0.85; ///< concentration of the phases; a standard deviation of 0.09 periods

struct CommandName {
    MotorCommand command;
    const char* name;
};
constexpr CommandName command_names[]{
    {MotorCommand::control, "control"},    {MotorCommand::other_mode, "other mode"},
    {MotorCommand::enable, "enable"},      {MotorCommand::disable, "disable"},
    {MotorCommand::set_zero, "set zero"},  {MotorCommand::clear_faults, "clear faults"},
    {MotorCommand::poll, "poll"},          {MotorCommand::read, "read"},
    {MotorCommand::configure, "configure"}};

std::string times(std::uint64_t count) { return std::to_string(count) + " such commands"; }

} // namespace

void PhaseWatch::take_reference(std::int64_t stamp_ns) noexcept {
    if (reference_ns_ && event_ns_ && stamp_ns > *reference_ns_) {
        const double phase = 2 * std::numbers::pi * static_cast<double>(*event_ns_ - *reference_ns_) /
                             static_cast<double>(stamp_ns - *reference_ns_);
        sum_cos_ += std::cos(phase);
        sum_sin_ += std::sin(phase);
        ++events_;
    }
    reference_ns_ = stamp_ns;
    event_ns_.reset();
}

void PhaseWatch::take_event(std::int64_t stamp_ns) noexcept { event_ns_ = event_ns_.value_or(stamp_ns); }

double PhaseWatch::concentration() const noexcept {
    return events_ > 0 ? std::hypot(sum_cos_, sum_sin_) / static_cast<double>(events_) : 0;
}

void HostWatch::take(MotorCommand command, bool only_torque, std::int64_t stamp_ns) noexcept {
    const auto index = static_cast<std::size_t>(command);
    if (command == MotorCommand::control) {
        changes_ += counts_[index] > 0 && only_torque != only_torque_ ? 1 : 0;
        only_torque_ = only_torque;
        polls_in_commands_.take_reference(stamp_ns);
        commands_in_polls_.take_event(stamp_ns);
    } else if (command == MotorCommand::poll) {
        polls_in_commands_.take_event(stamp_ns);
        commands_in_polls_.take_reference(stamp_ns);
    }
    ++counts_[index];
}

/// Returns true if the polls come repeatedly between commands, and at no fixed phase of them. The more
/// frequent of the two is the reference. Polls before or after all commands have no phase.
bool HostWatch::has_second_poller() const {
    const std::uint64_t commands = count(MotorCommand::control);
    const std::uint64_t polls = count(MotorCommand::poll);
    const PhaseWatch& phases = polls > commands ? commands_in_polls_ : polls_in_commands_;
    return polls >= repeated && commands >= repeated &&
           static_cast<double>(polls) > share_of_two * static_cast<double>(commands) &&
           phases.events() >= repeated && phases.concentration() < of_one_program;
}

std::vector<BusFinding> HostWatch::findings(const std::string& motor, bool needs_polls) const {
    std::vector<BusFinding> findings;
    const std::string confirm = "stop the other programs one by one, and look again";
    const std::uint64_t clears = count(MotorCommand::clear_faults);
    if (clears >= repeated) {
        findings.push_back({"faults_cleared", "a program clears the faults of " + motor + " repeatedly",
                            times(clears), confirm,
                            "Read positions without clearing faults: some libraries do it to poll a motor."});
    }
    if (count(MotorCommand::set_zero) > 0) {
        findings.push_back({"zero_moved", "a program sets the zero of " + motor,
                            times(count(MotorCommand::set_zero)), "compare its angle with a mark on the arm",
                            "Set zeros before the arm is used. Correct zero_rad."});
    }
    if (!needs_polls && has_second_poller()) {
        findings.push_back({"polled_beside_commands",
                            "a program polls " + motor + " in addition to the one that commands it",
                            std::to_string(count(MotorCommand::poll)) + " polls, " +
                                std::to_string(count(MotorCommand::control)) + " commands",
                            confirm,
                            "Run one program on the bus: answers to a second one come at other times."});
    }
    const auto commands = static_cast<double>(count(MotorCommand::control));
    if (changes_ >= 2 * repeated && static_cast<double>(changes_) > share_of_two * commands) {
        findings.push_back(
            {"two_controllers", "two programs command " + motor,
             std::to_string(changes_) + " changes between commands with and without stiffness or damping",
             confirm, "Let only one program command the arm."});
    }
    if (other_host_ >= repeated) {
        findings.push_back({"two_hosts", motor + " answers two hosts",
                            std::to_string(other_host_) + " answers to another host", confirm,
                            "Run one program on the bus, or correct the host in the description."});
    }
    return findings;
}

std::string HostWatch::summary() const {
    std::string text;
    for (const auto& [command, name] : command_names) {
        if (count(command) > 0) {
            text += (text.empty() ? "" : ", ") + std::to_string(count(command)) + " " + name;
        }
    }
    return text;
}

} // namespace dfdyn::tools
