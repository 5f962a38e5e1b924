// SPDX-License-Identifier: Apache-2.0
#include "tools/can/motors/host_watch.hpp"

namespace dfdyn::tools {

namespace {

using hal::MotorCommand;

constexpr std::uint64_t repeated = 5; ///< fewer may be commands of a person
constexpr double share_of_two = 0.05; ///< of all commands; a smaller share may be the start of one program

struct CommandName {
    MotorCommand command;
    const char* name;
};
constexpr CommandName command_names[]{
    {MotorCommand::control, "control"},           {MotorCommand::enable, "enable"},
    {MotorCommand::disable, "disable"},           {MotorCommand::set_zero, "set zero"},
    {MotorCommand::clear_faults, "clear faults"}, {MotorCommand::poll, "poll"},
    {MotorCommand::configure, "configure"}};

std::string times(std::uint64_t count) { return std::to_string(count) + " such commands"; }

} // namespace

void HostWatch::take(MotorCommand command, bool only_torque) noexcept {
    const auto index = static_cast<std::size_t>(command);
    if (command == MotorCommand::control) {
        changes_ += counts_[index] > 0 && only_torque != only_torque_ ? 1 : 0;
        only_torque_ = only_torque;
    }
    ++counts_[index];
}

std::vector<BusFinding> HostWatch::findings(const std::string& motor) const {
    std::vector<BusFinding> findings;
    const std::string confirm = "stop the other programs one by one, and look again";
    const std::uint64_t clears = count(MotorCommand::clear_faults);
    if (clears >= repeated) {
        findings.push_back({"faults_cleared", "a program clears the faults of " + motor + " repeatedly",
                            times(clears), confirm,
                            "read positions without clearing faults; some libraries do it to poll a motor"});
    }
    if (count(MotorCommand::set_zero) > 0) {
        findings.push_back({"zero_moved", "a program sets the zero of " + motor,
                            times(count(MotorCommand::set_zero)), "compare its angle with a mark on the arm",
                            "set zeros before the arm is used; correct zero_rad"});
    }
    const auto commands = static_cast<double>(count(MotorCommand::control));
    const std::uint64_t polls = count(MotorCommand::poll);
    if (polls >= repeated && commands >= repeated && static_cast<double>(polls) > share_of_two * commands) {
        findings.push_back({"polled_beside_commands",
                            "a program polls " + motor + " in addition to the one that commands it",
                            std::to_string(count(MotorCommand::poll)) + " polls, " +
                                std::to_string(count(MotorCommand::control)) + " commands",
                            confirm, "one program on the bus; its answers come in addition, at other times"});
    }
    if (changes_ >= 2 * repeated && static_cast<double>(changes_) > share_of_two * commands) {
        findings.push_back(
            {"two_controllers", "two programs command " + motor,
             std::to_string(changes_) + " changes between commands with and without stiffness or damping",
             confirm, "one program that commands the arm"});
    }
    if (other_host_ >= repeated) {
        findings.push_back({"two_hosts", motor + " answers two hosts",
                            std::to_string(other_host_) + " answers to another host", confirm,
                            "one program on the bus, or the host in the description"});
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
