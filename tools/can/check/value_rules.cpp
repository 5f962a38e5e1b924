// SPDX-License-Identifier: Apache-2.0
// Rules for faults of the values of a joint or of the sensor, one rule each.
#include "tools/base/text/number.hpp"
#include "tools/can/check/bus_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace dfdyn::tools {

namespace {

std::string share_text(std::uint64_t count, std::uint64_t of, const char* what) {
    return std::to_string(count) + " of " + std::to_string(of) + " " + what + " (" +
           percent(of > 0 ? static_cast<double>(count) / static_cast<double>(of) : 0) + ")";
}

struct Joint {
    const ValueWatch& watch;
    std::uint64_t restarts;
    std::vector<JumpCause> causes; ///< causes of its jumps
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

/// Number of jumps; only the first ones are stored.
std::string jumps_text(const Joint& joint, std::uint64_t count) {
    return (joint.watch.has_more_jumps() ? "at least " : "") + std::to_string(count);
}
std::string of_jumps(const Joint& joint, std::uint64_t count) {
    return (joint.watch.has_more_jumps() ? "at least " : "") + of_positions(joint, count);
}

std::uint64_t caused_by(const Joint& joint, JumpCause cause) {
    return static_cast<std::uint64_t>(std::ranges::count(joint.causes, cause));
}

constexpr std::array<JointRule, 12> joint_rules{{
    {"device_restarted", "has a board that restarted while it was sending", false,
     [](const Joint& joint) { return joint.restarts; },
     [](const Joint&, std::uint64_t count) { return std::to_string(count) + " boot-ups between its values"; },
     "candump IFACE,700:780 shows 00, the boot-up", "Check the board's supply. Look up its last error."},
    {"position_wrap", "has an encoder that wraps after a turn", false,
     [](const Joint& joint) { return caused_by(joint, JumpCause::wrap); },
     [](const Joint& joint, std::uint64_t count) {
         return of_jumps(joint, count) + " are one turn from the one before";
     },
     "turn the joint by hand past that angle",
     "Let the device count turns, or move its zero and correct zero_rad."},
    {"position_jump", "has impossible jumps of the position", false,
     [](const Joint& joint) { return caused_by(joint, JumpCause::unknown); },
     [](const Joint& joint, std::uint64_t count) {
         return of_jumps(joint, count) +
                formatted(" are far from the one before, by up to %.3g rad", joint.watch.largest_jump_rad());
     },
     "read the angle with the maker's own program before and after",
     "Check the board's supply: a board that restarts loses its zero. Look for a second sender. Check the "
     "encoder's cable."},
    {"zero_lost", "has an encoder that restarted at its zero", false,
     [](const Joint& joint) { return caused_by(joint, JumpCause::zero_lost); },
     [](const Joint& joint, std::uint64_t count) {
         return jumps_text(joint, count) +
                " times its positions continue from the device's own zero, far from the "
                "one before";
     },
     "read the angle with the maker's own program before and after switching the board off and on",
     "Check the board's supply. Set its zero, or use an absolute encoder. Start the program again."},
    {"bits_flipped", "has single wrong positions", false,
     [](const Joint& joint) { return caused_by(joint, JumpCause::bits_flipped); },
     [](const Joint& joint, std::uint64_t count) {
         return jumps_text(joint, count) + " jumps, each with an immediate return";
     },
     "CAN's checksum detects errors on the wire, so compare the device's own value with its frames",
     "Check the memory of the device and of any gateway. Check the encoder's cable."},
    {"bit_stuck", "has a stuck bit in its positions", false,
     [](const Joint& joint) { return caused_by(joint, JumpCause::bit_stuck); },
     [](const Joint& joint, std::uint64_t count) {
         return jumps_text(joint, count) +
                formatted(" jumps of one bit, by up to %.3g rad", joint.watch.largest_jump_rad());
     },
     "turn the joint slowly: the same bit never changes (candump -b IFACE)",
     "Check the lines of a parallel encoder. Check the encoder's memory."},
    {"frames_replayed", "repeats positions of an earlier time", false,
     [](const Joint& joint) { return caused_by(joint, JumpCause::frames_replayed); },
     [](const Joint& joint, std::uint64_t count) {
         return jumps_text(joint, count) + " jumps to positions that repeat earlier ones in order";
     },
     "stop all programs that send on this bus, then look again", "Stop the program that replays a log here."},
    {"nodes_swapped", "has the positions of another joint", false,
     [](const Joint& joint) { return caused_by(joint, JumpCause::nodes_swapped); },
     [](const Joint& joint, std::uint64_t count) {
         return jumps_text(joint, count) +
                " jumps to the position of another joint, which jumped to this one's at the same time";
     },
     "move the joint by hand: the other joint's bytes change", "Exchange the identifiers of the two boards."},
    {"position_zeros", "has zeros between other positions", false,
     [](const Joint& joint) { return joint.watch.zeros(); },
     [](const Joint& joint, std::uint64_t count) { return of_positions(joint, count) + " are exactly 0"; },
     "candump IFACE: the bytes of the position are 0",
     "Check the board's supply and encoder: it sends 0 while it restarts or has no estimate."},
    {"encoder_frozen", "has an encoder that is frozen while the joint moves", false,
     [](const Joint& joint) { return joint.watch.frozen_positions(); },
     [](const Joint& joint, std::uint64_t count) {
         return of_positions(joint, count) + " repeat the one before, after an impossibly sudden stop";
     },
     "move the joint by hand: the bytes do not change",
     "Check the encoder and its cable. Restart the board."},
    {"effort_frozen", "has an effort that does not change while the joint moves", true,
     [](const Joint& joint) { return joint.watch.frozen_efforts(); },
     [](const Joint& joint, std::uint64_t count) {
         return of_efforts(joint, count) + " are the same number";
     },
     "load the joint by hand: the bytes do not change",
     "Map the measured effort, not the commanded one. Restart the drive."},
    {"effort_saturated", "has an effort at the end of its range", true,
     [](const Joint& joint) { return joint.watch.saturated_efforts(); },
     [](const Joint& joint, std::uint64_t count) { return of_efforts(joint, count) + " are at an end"; },
     "candump IFACE: FF7F or 0080 in the effort's bytes",
     "Set a larger unit in the drive's PDO. Reduce the speed of the motion or the load."},
}};

/// Returns false if a finding indicates values of two alternating senders.
bool has_one_sender(const BusCheck& check, int joint) {
    const BusStreams::value_type* const stream = check.position_stream(static_cast<std::size_t>(joint));
    return stream == nullptr || !sends_more(check, *stream);
}

/// Finding for a joint without values on an identifier on which others have some.
BusFinding missing_joint(const BusCheck& check, std::size_t joint) {
    const CheckedJoint& checked = check.joints()[joint];
    const BusStreams::value_type& source = *check.position_stream(joint);
    const bool never = checked.frames == 0;
    return {never ? "silent_source" : "source_stopped",
            id_text(source.first) + " (joint " + std::to_string(joint + 1) + ")" +
                (never ? " is never sent" : " is no longer sent"),
            never ? formatted("no frame of this joint in %.3g s, but others on its identifier",
                              check.duration_s())
                  : formatted("last frame of this joint %.3g s before the last one on its identifier",
                              seconds_of(source.second.last_ns - checked.last_ns)),
            "read the motor's state with the maker's own program",
            "Check the motor's power and cable. Check its number in the description."};
}

} // namespace

std::vector<BusFinding> value_findings(const BusCheck& check) {
    std::vector<BusFinding> findings;
    std::vector<std::vector<PositionJump>> jumps;
    std::ranges::transform(check.joints(), std::back_inserter(jumps),
                           [](const CheckedJoint& joint) { return joint.values.first_jumps(); });
    const std::vector<std::vector<JumpCause>> causes = causes_of(jumps);
    for (std::size_t joint = 0; joint < check.joints().size(); ++joint) {
        const bool one_sender = has_one_sender(check, static_cast<int>(joint));
        const CheckedJoint& checked = check.joints()[joint];
        const Joint watched{checked.values, checked.restarts, causes[joint]};
        if (check.lacks_values(joint)) {
            findings.push_back(missing_joint(check, joint));
        }
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
        if (std::ranges::all_of(board.joint,
                                [&](int joint) { return joint < 0 || has_one_sender(check, joint); })) {
            std::ranges::move(board.board->findings(), std::back_inserter(findings));
        }
    }
    if (check.sensor() != nullptr) {
        std::ranges::move((*check.sensor())->findings(), std::back_inserter(findings));
    }
    return findings;
}

} // namespace dfdyn::tools
