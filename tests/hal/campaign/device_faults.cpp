// SPDX-License-Identifier: Apache-2.0
#include "tests/hal/campaign/fault_actions.hpp"

#include <map>
#include <optional>

namespace dfdyn::tests {

using Role = Sent::Role;

void zero_positions(FaultSite& site) {
    const int unit = site.pick(2);
    site.change([&](Sent& sent) {
        if (is_joint(sent, unit)) {
            clear_position(sent.frame, unit);
        }
    });
}
/// Silent for a third of the time, zero for another, and then where it is.
void restart_absolute(FaultSite& site) {
    const std::int64_t third_ns = (site.end_ns - site.begin_ns) / 3;
    const int unit = site.pick(2);
    FaultSite silent{site.traffic, site.begin_ns, site.begin_ns + third_ns, site.engine, site.truth};
    FaultSite zero{site.traffic, silent.end_ns, silent.end_ns + third_ns, site.engine, site.truth};
    silent.remove([&](const Sent& sent) { return is_joint(sent, unit); });
    zero.change([&](Sent& sent) {
        if (is_joint(sent, unit)) {
            clear_position(sent.frame, unit);
        }
    });
}
/// Silent for a while, or not at all, and then counted from where it was switched on.
void restart_incremental(FaultSite& site) {
    const int unit = site.pick(2);
    const std::int64_t back_ns = site.begin_ns + (site.chance(0.5) ? 0 : bus_period * site.pick(200));
    std::erase_if(site.traffic, [&](const Sent& sent) {
        return is_joint(sent, unit) && sent.true_ns >= site.begin_ns && sent.true_ns < back_ns;
    });
    std::optional<double> begin;
    for (Sent& sent : site.traffic) {
        if (is_joint(sent, unit) && sent.true_ns >= back_ns) {
            const double now = position_of(sent.frame, unit);
            begin = begin.value_or(now);
            set_position(sent.frame, unit, now - *begin);
        }
    }
}

/// The bytes of `field` stay as they were at the begin.
template <class Covers, class Field>
static void freeze(const FaultSite& site, Covers covers, Field field) {
    std::map<std::uint32_t, hal::Frame> first;
    site.change([&](Sent& sent) {
        if (covers(sent)) {
            const hal::Frame& kept = first.emplace(sent.frame.id, sent.frame).first->second;
            const auto [begin, length] = field(sent.frame);
            std::copy_n(kept.data.begin() + begin, length, sent.frame.data.begin() + begin);
        }
    });
}
void freeze_encoder(FaultSite& site) {
    const int unit = site.pick(2);
    if (site.wait_for_motion(unit, 0.8)) {
        freeze(
            site, [&](const Sent& sent) { return is_joint(sent, unit); },
            [&](const hal::Frame& frame) { return position_bytes(frame, unit); });
    }
}
void freeze_effort(FaultSite& site) {
    const int unit = site.pick(2);
    if (site.wait_for_motion(unit, 0.8)) {
        freeze(
            site, [&](const Sent& sent) { return is_joint(sent, unit) && has_effort(sent.frame); },
            effort_bytes);
    }
}
void freeze_sensor(FaultSite& site) {
    freeze(
        site, [](const Sent& sent) { return sent.role == Role::wrench; },
        [](const hal::Frame& frame) {
            return Bytes{0, frame.length};
        });
}
void saturate_effort(FaultSite& site) {
    const int unit = site.pick(2);
    const bool high = site.chance(0.5);
    site.change([&](Sent& sent) {
        if (is_joint(sent, unit) && has_effort(sent.frame)) {
            const auto place = static_cast<std::size_t>(effort_bytes(sent.frame).begin);
            const std::size_t last = is_dbc(sent.frame) ? place : place + 1; // the more significant one
            sent.frame.data[2 * place + 1 - last] = high ? 0xFF : 0x00;
            sent.frame.data[last] = high ? 0x7F : 0x80;
        }
    });
}
void saturate_sensor(FaultSite& site) {
    site.change([](Sent& sent) {
        if (sent.role == Role::wrench) {
            saturate_half(sent.frame, sent.unit);
        }
    });
}

/// Another joint's motion, on the same identifier.
void second_joint(FaultSite& site) {
    const int unit = site.pick(2);
    const std::int64_t behind_ns = std::int64_t{bus_us} * (200 + site.pick(1600));
    site.add([&](const Sent& sent, Traffic& more) {
        if (is_joint(sent, unit)) {
            more.push_back(sent);
            move(more.back(), behind_ns);
            set_position(more.back().frame, unit, -0.7 * position_of(sent.frame, unit));
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
/// The values of 60 ms ago under fresh stamps.
void replay_old(FaultSite& site) {
    const int unit = site.pick(2);
    if (!site.wait_for_motion(unit, 0.8)) {
        return;
    }
    std::map<int, hal::Frame> sent_in;
    for (Sent& sent : site.traffic) {
        if (sent.role == Role::joints && sent.unit == (is_two_joint_board(sent.frame) ? 0 : unit)) {
            sent_in[sent.cycle] = sent.frame;
        }
    }
    site.change([&](Sent& sent) {
        const auto old = sent_in.find(sent.cycle - 30);
        if (is_joint(sent, unit) && old != sent_in.end()) {
            sent.frame.data = old->second.data;
        }
    });
}

void stick_bit(FaultSite& site) {
    const int unit = site.pick(2);
    std::optional<bool> stuck;
    const int bit = site.pick(4);
    site.change([&](Sent& sent) {
        if (is_joint(sent, unit)) {
            stuck = stuck.value_or(!position_bit(sent.frame, unit, bit));
            set_position_bit(sent.frame, unit, bit, *stuck);
        }
    });
}
/// Two boards with each other's identifiers, where both show that.
void swap_nodes(FaultSite& site) {
    std::array<const Sent*, 2> last{};
    for (const Sent& sent : site.traffic) {
        if (sent.role == Role::joints && sent.true_ns < site.begin_ns) {
            last[static_cast<std::size_t>(sent.unit)] = &sent;
        }
    }
    if (last[0] == nullptr || last[1] == nullptr) {
        return;
    }
    const double apart = std::abs(position_of(last[0]->frame, 0) - position_of(last[1]->frame, 1));
    if (apart > 0.2 * std::max(per_radian(last[0]->frame), per_radian(last[1]->frame))) {
        site.change([](Sent& sent) {
            if (sent.role == Role::joints && !is_two_joint_board(sent.frame)) {
                sent.frame.id = other_node(sent.frame.id);
            }
        });
    }
}

} // namespace dfdyn::tests
