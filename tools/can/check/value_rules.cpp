// SPDX-License-Identifier: Apache-2.0
// Rules for faults of the values of a joint or of the sensor, one rule each.
#include "tools/base/text/number.hpp"
#include "tools/can/check/bus_check.hpp"

#include <array>
#include <cmath>

namespace dfdyn::tools {

namespace {

/// ratio to the described rate; above it, values of two senders may alternate
constexpr double rate_of_one = 1.02;

std::string share_text(std::uint64_t count, std::uint64_t of, const char* what) {
    return std::to_string(count) + " of " + std::to_string(of) + " " + what + " (" +
           percent(of > 0 ? static_cast<double>(count) / static_cast<double>(of) : 0) + ")";
}

struct Joint {
    const ValueWatch& watch;
    std::uint64_t restarts;
};

struct JointRule {
    const char* name;
    const char* what;
    bool of_effort; ///< relevant only if the joints measure the outputs
    std::uint64_t (*count)(const Joint&);
    std::string (*evidence)(const Joint&, std::uint64_t count);
    const char* confirm;
    const char* fix;
};

std::string of_positions(const Joint& joint, std::uint64_t count) {
    return share_text(count, joint.watch.positions(), "positions");
}
std::string of_efforts(const Joint& joint, std::uint64_t count) {
    return share_text(count, joint.watch.efforts(), "efforts");
}

constexpr std::array<JointRule, 7> joint_rules{{
    {"device_restarted", "has a board that restarted while it sent", false,
     [](const Joint& joint) { return joint.restarts; },
     [](const Joint&, std::uint64_t count) { return std::to_string(count) + " boot-ups between its values"; },
     "candump IFACE,700:780 shows 00, the boot-up", "check the board's supply; look up its last error"},
    {"position_wrap", "has an encoder that begins anew after a turn", false,
     [](const Joint& joint) { return joint.watch.wraps(); },
     [](const Joint& joint, std::uint64_t count) {
         return of_positions(joint, count) + " are a turn away from the one before";
     },
     "turn the joint by hand past that angle", "let the device count turns, or move its zero; zero_rad"},
    {"position_jump", "has positions that it cannot have reached", false,
     [](const Joint& joint) { return joint.watch.jumps() - joint.watch.wraps(); },
     [](const Joint& joint, std::uint64_t count) {
         return of_positions(joint, count) +
                formatted(" are far from the one before, by up to %.3g rad", joint.watch.largest_jump_rad());
     },
     "read the angle with the maker's own program before and after",
     "a board that restarts loses its zero; a second sender; a loose encoder cable"},
    {"position_zeros", "shows zeros between other positions", false,
     [](const Joint& joint) { return joint.watch.zeros(); },
     [](const Joint& joint, std::uint64_t count) { return of_positions(joint, count) + " are exactly 0"; },
     "candump IFACE: the bytes of the position are 0",
     "a board sends 0 while it restarts, or where it has no estimate: check its supply and encoder"},
    {"encoder_frozen", "has an encoder that stands while the joint moves", false,
     [](const Joint& joint) { return joint.watch.frozen_positions(); },
     [](const Joint& joint, std::uint64_t count) {
         return of_positions(joint, count) + " repeat the one before, after a stop that no joint can do";
     },
     "move the joint by hand: the bytes do not change", "check the encoder and its cable; restart the board"},
    {"effort_frozen", "has an effort that does not change while the joint moves", true,
     [](const Joint& joint) { return joint.watch.frozen_efforts(); },
     [](const Joint& joint, std::uint64_t count) {
         return of_efforts(joint, count) + " are the same number";
     },
     "load the joint by hand: the bytes do not change",
     "map the effort that is measured, not the one commanded; restart the drive"},
    {"effort_saturated", "has an effort at the end of its numbers", true,
     [](const Joint& joint) { return joint.watch.saturated_efforts(); },
     [](const Joint& joint, std::uint64_t count) { return of_efforts(joint, count) + " are at an end"; },
     "candump IFACE: FF7F or 0080 in the effort's bytes",
     "a larger unit in the drive's PDO; a slower motion, a smaller load"},
}};

} // namespace

std::vector<BusFinding> value_findings(const BusCheck& check) {
    std::vector<BusFinding> findings;
    for (std::size_t joint = 0; joint < check.joints().size(); ++joint) {
        const BusStream* const stream = check.position_stream(joint);
        const bool one_sender = stream == nullptr || stream->rate_hz() <= rate_of_one * stream->expected_hz;
        const Joint watched{check.joints()[joint], check.restarts(joint)};
        for (const JointRule& rule : joint_rules) {
            const std::uint64_t count = rule.count(watched);
            const bool matters = !rule.of_effort || check.sensor() == nullptr;
            if (one_sender && matters && count > 0) {
                findings.push_back({rule.name, "joint " + std::to_string(joint + 1) + " " + rule.what,
                                    rule.evidence(watched, count), rule.confirm, rule.fix});
            }
        }
    }
    for (const BusBoard& board : check.boards()) {
        std::ranges::move(board.board->findings(), std::back_inserter(findings));
    }
    if (check.sensor() != nullptr) {
        std::ranges::move((*check.sensor())->findings(), std::back_inserter(findings));
    }
    return findings;
}

} // namespace dfdyn::tools
