// SPDX-License-Identifier: Apache-2.0
#include "tests/hal/campaign/fault_actions.hpp"

#include <map>
#include <optional>

namespace dfdyn::tests {

using Role = Sent::Role;

void FaultSite::show_position(Sent& sent, std::size_t joint, double position_rad) const {
    sent.shown[joint].position_rad = position_rad;
    copy_bits(arm.frames(sent.unit, sent.shown).frame[sent.part], fields(sent).position[joint], sent.frame);
}
void FaultSite::show_effort(Sent& sent, std::size_t joint, double effort) const {
    sent.shown[joint].effort = effort;
    copy_bits(arm.frames(sent.unit, sent.shown).frame[sent.part], fields(sent).effort[joint], sent.frame);
}

void zero_positions(FaultSite& site) {
    const std::size_t joint = site.pick_joint();
    site.change([&](Sent& sent) {
        if (site.has_position(sent, joint)) {
            sent.uninformative = true;
            site.show_position(sent, joint, site.arm.zero_rad[joint]);
        }
    });
}
/// Silent for a third of the time, zero for another, then correct.
void restart_absolute(FaultSite& site) {
    const std::int64_t third_ns = (site.end_ns - site.begin_ns) / 3;
    const std::size_t joint = site.pick_joint();
    FaultSite silent = site;
    silent.end_ns = site.begin_ns + third_ns;
    FaultSite zero = site;
    zero.begin_ns = silent.end_ns;
    zero.end_ns = silent.end_ns + third_ns;
    silent.remove([&](const Sent& sent) { return site.is_joint(sent, joint); });
    zero.change([&](Sent& sent) {
        if (site.has_position(sent, joint)) {
            sent.uninformative = true;
            site.show_position(sent, joint, site.arm.zero_rad[joint]);
        }
    });
}
/// Silent for a while, or not at all, then counting from the position at power-on.
void restart_incremental(FaultSite& site) {
    const std::size_t joint = site.pick_joint();
    const std::int64_t back_ns = site.begin_ns + (site.chance(0.5) ? 0 : bus_period * site.pick(200));
    std::erase_if(site.traffic, [&](const Sent& sent) {
        return site.is_joint(sent, joint) && sent.true_ns >= site.begin_ns && sent.true_ns < back_ns;
    });
    std::optional<double> begin_rad;
    for (Sent& sent : site.traffic) { // a second sender has its own encoder
        if (site.has_position(sent, joint) && !sent.other_sender && sent.true_ns >= back_ns) {
            const double now_rad = sent.shown[joint].position_rad;
            begin_rad = begin_rad.value_or(now_rad);
            site.show_position(sent, joint, now_rad - *begin_rad + site.arm.zero_rad[joint]);
        }
    }
}

/// Freezes the values at the start, if the joint passes five counts within `max_age`. A slower joint may have
/// stopped, as far as its counts show.
void freeze_encoder(FaultSite& site) {
    const std::size_t joint = site.pick_joint();
    std::optional<double> kept_rad;
    const double least_rad_s = std::max(0.8, 5 * site.arm.step_rad[joint] / seconds_of(bus_max_age));
    if (site.wait_for_motion(joint, least_rad_s)) {
        site.change([&](Sent& sent) {
            if (site.has_position(sent, joint)) {
                sent.uninformative = kept_rad.has_value();
                kept_rad = kept_rad.value_or(sent.shown[joint].position_rad);
                site.show_position(sent, joint, *kept_rad);
            }
        });
    }
}
void freeze_effort(FaultSite& site) {
    const std::size_t joint = site.pick_joint();
    std::optional<double> kept;
    if (site.wait_for_motion(joint, 0.8)) {
        site.change([&](Sent& sent) {
            if (site.has_effort(sent, joint)) {
                kept = kept.value_or(sent.shown[joint].effort);
                site.show_effort(sent, joint, *kept);
            }
        });
    }
}
void freeze_sensor(FaultSite& site) {
    std::map<std::size_t, hal::Frame> kept;
    site.change([&](Sent& sent) {
        if (sent.role == Role::wrench) {
            sent.frame.data = kept.emplace(sent.part, sent.frame).first->second.data;
        }
    });
}
void saturate_effort(FaultSite& site) {
    const std::size_t joint = site.pick_joint();
    const double beyond = site.chance(0.5) ? 1e6 : -1e6;
    site.change([&](Sent& sent) {
        if (site.has_effort(sent, joint)) {
            site.show_effort(sent, joint, beyond);
        }
    });
}
void saturate_sensor(FaultSite& site) {
    site.change([&](Sent& sent) {
        if (sent.role == Role::wrench) {
            site.arm.saturate_wrench(sent.frame, sent.part);
        }
    });
}

/// Sends another joint's motion on the same identifier.
void second_joint(FaultSite& site) {
    const std::size_t joint = site.pick_joint();
    const std::int64_t behind_ns = std::int64_t{bus_us} * (200 + site.pick(1600));
    const double zero_rad = site.arm.zero_rad[joint];
    site.add([&](const Sent& sent, Traffic& more) {
        if (site.has_position(sent, joint)) {
            more.push_back(sent);
            move(more.back(), behind_ns);
            more.back().other_sender = true;
            const double position_rad = zero_rad - 0.7 * (sent.shown[joint].position_rad - zero_rad);
            site.show_position(more.back(), joint, position_rad);
        }
    });
}
void second_sensor(FaultSite& site) {
    const std::int64_t behind_ns = std::int64_t{bus_us} * (200 + site.pick(1600));
    site.add([&](const Sent& sent, Traffic& more) {
        if (sent.role == Role::wrench) {
            more.push_back(sent);
            move(more.back(), behind_ns);
            more.back().frame.data[2] ^= 0x31U;
            more.back().frame.data[3] ^= 0x31U;
        }
    });
}
/// Sends the values of 60 ms ago with new stamps.
void replay_old(FaultSite& site) {
    const std::size_t joint = site.pick_joint();
    if (!site.wait_for_motion(joint, 0.8)) {
        return;
    }
    std::map<std::pair<int, std::size_t>, Sent> sent_in; // by cycle and part
    for (const Sent& sent : site.traffic) {
        if (site.is_joint(sent, joint)) {
            sent_in[{sent.cycle, sent.part}] = sent;
        }
    }
    site.change([&](Sent& sent) {
        const auto old = sent_in.find({sent.cycle - 30, sent.part});
        if (site.is_joint(sent, joint) && old != sent_in.end()) {
            sent.frame.data = old->second.frame.data;
            sent.shown = old->second.shown;
        }
    });
}

/// Fixes one of four bits with a weight of about 6 to 100 mrad.
void stick_bit(FaultSite& site) {
    const std::size_t joint = site.pick_joint();
    const double zero_rad = site.arm.zero_rad[joint];
    const double step_rad = site.arm.step_rad[joint];
    const double place = std::ceil(std::log2(6e-3 / step_rad)) + site.pick(4);
    const double worth_rad = step_rad * std::exp2(place);
    std::optional<bool> stuck;
    site.change([&](Sent& sent) {
        if (site.has_position(sent, joint)) {
            const double position_rad = sent.shown[joint].position_rad;
            const bool bit = std::llround(std::floor((position_rad - zero_rad) / worth_rad)) % 2 != 0;
            stuck = stuck.value_or(!bit);
            const double added_rad = bit == *stuck ? 0 : *stuck ? worth_rad : -worth_rad;
            site.show_position(sent, joint, position_rad + added_rad);
        }
    });
}
/// Exchanges the identifiers of two boards, if the positions differ enough.
void swap_nodes(FaultSite& site) {
    std::array<std::optional<double>, 2> last;
    for (const Sent& sent : site.traffic) {
        for (std::size_t joint = 0; joint < 2; ++joint) {
            if (site.has_position(sent, joint) && !sent.uninformative && sent.true_ns < site.begin_ns) {
                last[joint] = sent.shown[joint].position_rad;
            }
        }
    }
    if (site.arm.boards < 2 || !last[0] || !last[1] || std::abs(*last[0] - *last[1]) < 0.2) {
        return;
    }
    site.change([&](Sent& sent) {
        if (sent.role == Role::joints) {
            const wire::Joint own = sent.shown[sent.unit];
            const wire::Joint other = sent.shown[1 - sent.unit];
            site.show_position(sent, sent.unit, other.position_rad);
            site.show_effort(sent, sent.unit, other.effort);
            sent.shown[1 - sent.unit] = own;
        }
    });
}

} // namespace dfdyn::tests
