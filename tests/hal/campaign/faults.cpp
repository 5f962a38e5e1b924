#include <optional>
// SPDX-License-Identifier: Apache-2.0
#include "tests/hal/campaign/faults.hpp"

#include "tests/hal/campaign/frame_fields.hpp"

#include <map>

namespace dfdyn::tests {

namespace {

using Role = Sent::Role;

bool is_device(const Sent& sent) { return sent.role == Role::joints || sent.role == Role::wrench; }
bool is_joint(const Sent& sent, int unit) {
    return sent.role == Role::joints && (sent.unit == unit || is_two_joint_board(sent.frame));
}

void lose_frames(FaultSite& site) {
    site.remove([&](const Sent& sent) { return is_device(sent) && site.chance(0.2); });
}
void lose_cycles(FaultSite& site) {
    site.remove([](const Sent& sent) { return is_device(sent); });
}
void silence_board(FaultSite& site) {
    const int unit = site.pick(2);
    site.remove([&](const Sent& sent) { return is_joint(sent, unit); });
}
void silence_sensor(FaultSite& site) {
    site.remove([](const Sent& sent) { return sent.role == Role::wrench; });
}

void move(Sent& sent, std::int64_t by_ns) {
    sent.true_ns += by_ns;
    sent.frame.stamp_ns += by_ns;
}
void delay_frames(FaultSite& site) {
    site.change([&](Sent& sent) {
        if (is_device(sent) && site.chance(0.1)) {
            move(sent, std::int64_t{bus_us} * site.pick(2400));
        }
    });
    site.sort();
}
void duplicate_frames(FaultSite& site) {
    site.add([&](const Sent& sent, Traffic& more) {
        if (is_device(sent) && site.chance(0.2)) {
            more.push_back(sent);
            move(more.back(), std::int64_t{bus_us} * (50 + site.pick(2150)));
        }
    });
}
/// They are read in another order than they were stamped in.
void swap_frames(FaultSite& site) {
    for (std::size_t i = 1; i < site.traffic.size(); ++i) {
        if (site.covers(site.traffic[i]) && is_device(site.traffic[i]) && site.chance(0.2)) {
            std::swap(site.traffic[i - 1].true_ns, site.traffic[i].true_ns);
        }
    }
    site.sort();
}
/// Not those of efforts, which may step.
void corrupt_bits(FaultSite& site) {
    site.change([&](Sent& sent) {
        if (is_device(sent) && sent.frame.length > 0 && site.chance(0.1)) {
            const bool has_effort_too = sent.role == Role::joints && has_effort(sent.frame);
            const Bytes bytes =
                has_effort_too ? position_bytes(sent.frame, sent.unit) : Bytes{0, sent.frame.length};
            const int bit = 8 * bytes.begin + site.pick(8 * bytes.length);
            sent.frame.data[static_cast<std::size_t>(bit / 8)] ^= static_cast<std::uint8_t>(1 << bit % 8);
        }
    });
}

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
void freeze(const FaultSite& site, Covers covers, Field field) {
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
            sent.frame.data[place] = high ? 0xFF : 0x00;
            sent.frame.data[place + 1] = high ? 0x7F : 0x80;
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

void stray_stamp(FaultSite& site, std::int64_t sign) {
    constexpr std::array<std::int64_t, 4> sizes{3'000'000, 40'000'000, 700'000'000, 3'600'000'000'000};
    int left = 3;
    site.change([&](Sent& sent) {
        if (left > 0 && site.chance(0.05)) {
            sent.frame.stamp_ns += sign * sizes[static_cast<std::size_t>(site.pick(4))];
            --left;
        }
    });
}
void stamp_ahead(FaultSite& site) { stray_stamp(site, 1); }
void stamp_behind(FaultSite& site) { stray_stamp(site, -1); }
void set_clock(const FaultSite& site, std::int64_t by_ns) {
    for (Sent& sent : site.traffic) {
        sent.frame.stamp_ns += sent.true_ns >= site.begin_ns ? by_ns : 0;
    }
}
void clock_back(FaultSite& site) { set_clock(site, -std::int64_t{1'000'000} * (50 + site.pick(9'000))); }
void clock_forward(FaultSite& site) { set_clock(site, std::int64_t{1'000'000} * (50 + site.pick(9'000))); }
void clock_slightly(FaultSite& site) {
    set_clock(site, std::int64_t{bus_us} * (1500 + site.pick(2500)) * (site.chance(0.5) ? 1 : -1));
}

hal::Frame error_frame(std::uint32_t classes, std::int64_t stamp_ns) {
    hal::Frame frame = wire::frame(classes, {0, 0, 0, 0, 0, 0, 0, 0});
    frame.error = true;
    frame.stamp_ns = stamp_ns;
    return frame;
}
void bus_off(FaultSite& site) {
    std::int64_t clock_ns = 0; // of the stamps, against true time
    site.change([&](Sent& sent) { clock_ns = sent.frame.stamp_ns - sent.true_ns; });
    site.remove([](const Sent&) { return true; });
    site.traffic.push_back({error_frame(0x040, site.begin_ns + clock_ns), site.begin_ns});
    site.traffic.push_back({error_frame(0x100, site.end_ns + clock_ns), site.end_ns});
    site.sort();
}

void lose_syncs(FaultSite& site) {
    site.remove([&](const Sent& sent) { return sent.role == Role::sync && site.chance(0.3); });
}
/// Answers come later and later, until after the next SYNC.
void late_answers(FaultSite& site) {
    const bool synchronous =
        std::ranges::any_of(site.traffic, [](const Sent& sent) { return sent.role == Role::sync; });
    const double length = static_cast<double>(site.end_ns - site.begin_ns);
    const std::int64_t most_ns = std::int64_t{bus_us} * (600 + site.pick(2200));
    site.change([&](Sent& sent) {
        if (synchronous && sent.role == Role::joints) {
            const double part = static_cast<double>(sent.true_ns - site.begin_ns) / length;
            const double grown = std::min(1.0, 3 * std::min(part, 1 - part));
            move(sent, static_cast<std::int64_t>(grown * static_cast<double>(most_ns)));
        }
    });
    site.sort();
}
void overload(FaultSite& site) {
    std::vector<std::size_t> waiting;
    std::uniform_real_distribution<double> load(0.7, 1.15);
    const double others = load(site.engine);
    Traffic dummy;
    for (std::int64_t t = site.begin_ns; t < site.end_ns; t += 130 * bus_us) {
        if (site.chance(others * 0.8)) {
            dummy.push_back({wire::frame(site.chance(0.7) ? 0x0F0 : 0x380, {1, 2, 3, 4, 5, 6, 7, 8}), t});
            dummy.back().frame.stamp_ns = t;
        }
    }
    site.traffic.insert(site.traffic.end(), dummy.begin(), dummy.end());
    site.sort();
    std::int64_t free_ns = site.begin_ns;
    Traffic queue;
    Traffic done;
    const auto serve_until = [&](std::int64_t time_ns) {
        while (!queue.empty() && free_ns < time_ns) {
            const auto first =
                std::ranges::min_element(queue, {}, [](const Sent& sent) { return sent.frame.id; });
            free_ns += 125 * bus_us;
            move(*first, free_ns - first->true_ns);
            done.push_back(*first);
            queue.erase(first);
        }
        free_ns = std::max(free_ns, time_ns);
    };
    for (const Sent& sent : site.traffic) {
        if (site.covers(sent)) {
            serve_until(sent.true_ns - 125 * bus_us);
            queue.push_back(sent);
        }
    }
    serve_until(site.end_ns + 200 * bus_period);
    site.remove([](const Sent&) { return true; });
    std::erase_if(done, [&](const Sent& sent) { return sent.true_ns >= site.end_ns; });
    site.traffic.insert(site.traffic.end(), done.begin(), done.end());
    site.sort();
}

void malform(FaultSite& site) {
    site.change([&](Sent& sent) {
        if (!is_device(sent) || !site.chance(0.1)) {
            return;
        }
        sent.role = Role::noise; // for faults that are put on top
        switch (site.pick(4)) {
        case 0:
            sent.frame.length = static_cast<std::uint8_t>((sent.frame.length + 1 + site.pick(7)) % 9);
            sent.frame.length = sent.frame.length == 7 ? 8 : sent.frame.length; // 7: a saturated sensor
            break;
        case 1:
            sent.frame.remote = true;
            break;
        case 2:
            sent.frame.fd = true;
            break;
        default:
            sent.frame.extended = true;
            break;
        }
    });
}
void babble(FaultSite& site) {
    site.add([&](const Sent& sent, Traffic& more) {
        for (int i = 0; i < 3; ++i) {
            hal::Frame frame =
                wire::frame(static_cast<std::uint32_t>(0x700 + site.pick(0xFF)), {1, 2, 3, 4, 5, 6, 7, 8});
            frame.stamp_ns = sent.frame.stamp_ns;
            more.push_back({frame, sent.true_ns});
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

constexpr auto hides = Effect::hides;
constexpr auto misleads = Effect::misleads;
constexpr auto spoils = Effect::spoils;
constexpr auto mixes = Effect::none;
constexpr bool stays = false;

constexpr std::array faults{
    Fault{1, "frames lost", 0.1, 0.3, lose_frames, 0.06, spoils},
    Fault{2, "whole cycles lost", 0.002, 0.02, lose_cycles, 0.06, hides},
    Fault{3, "a board is silent", 0.01, 0.3, silence_board, 0.06, hides},
    Fault{4, "the sensor is silent", 0.01, 0.3, silence_sensor},
    Fault{5, "frames delayed", 0.1, 0.3, delay_frames, 0.45, spoils},
    Fault{6, "frames duplicated", 0.1, 0.3, duplicate_frames, 0.45, spoils},
    Fault{7, "frames overtaken", 0.1, 0.3, swap_frames, 0.3, spoils},
    Fault{8, "bits corrupted", 0.1, 0.3, corrupt_bits, 0.45, spoils},
    Fault{9, "positions are zero", 0.004, 0.2, zero_positions, 0.5, misleads},
    Fault{10, "a board with an absolute encoder restarts", 0.03, 0.4, restart_absolute, 0.1, hides},
    Fault{11, "a board with an incremental encoder restarts", 0.1, 0.1, restart_incremental, 0, misleads,
          stays},
    Fault{12, "an encoder is frozen", 0.05, 0.3, freeze_encoder, 0.5, misleads},
    Fault{13, "an effort is frozen", 0.1, 0.3, freeze_effort, 0.06, misleads, true, 0.05},
    Fault{14, "the sensor is frozen", 0.05, 0.3, freeze_sensor, 0.06, misleads, true, 0.012},
    Fault{15, "an effort is saturated", 0.01, 0.2, saturate_effort, 0.06, spoils},
    Fault{16, "the sensor is saturated", 0.01, 0.2, saturate_sensor, 0.06, spoils},
    Fault{17, "a second sender of a joint", 0.05, 0.3, second_joint, 0.5, misleads},
    Fault{18, "a second sender of the sensor", 0.05, 0.3, second_sensor, 0.06, spoils},
    Fault{19, "old frames replayed", 0.05, 0.3, replay_old, 0.5, misleads},
    Fault{20, "a stamp ahead", 0.1, 0.2, stamp_ahead, 0.15, spoils},
    Fault{21, "a stamp behind", 0.1, 0.2, stamp_behind, 0.06, spoils},
    Fault{22, "the clock is set back", 0.01, 0.01, clock_back, 0.15, hides},
    Fault{23, "the clock is set forward", 0.01, 0.01, clock_forward, 0.15, hides},
    Fault{24, "the clock is set by a few ms", 0.01, 0.01, clock_slightly, 0.5, hides},
    Fault{25, "bus-off", 0.01, 0.4, bus_off, 0.1, hides},
    Fault{26, "a SYNC is lost", 0.1, 0.3, lose_syncs, 0.3, spoils},
    Fault{27, "answers later than the next SYNC", 0.2, 0.5, late_answers, 0.3, misleads},
    Fault{28, "the bus is overloaded", 0.1, 0.4, overload, 0.4, hides, true, 0, 30e-3},
    Fault{29, "frames of another form", 0.1, 0.3, malform, 0.06, spoils},
    Fault{30, "a babbling node", 0.05, 0.2, babble},
    Fault{31, "a bit of the encoder is stuck", 0.05, 0.3, stick_bit, 0.5, misleads},
    Fault{32, "two nodes swapped", 0.05, 0.3, swap_nodes, 0.5, misleads},
};

} // namespace

bool FaultSite::wait_for_motion(int joint, double least_rad_s) {
    const auto index = static_cast<std::size_t>(joint);
    for (; begin_ns < end_ns; begin_ns += bus_period) {
        if (std::abs(truth.velocity(index, seconds_of(begin_ns))) > least_rad_s) {
            return true;
        }
    }
    return false;
}

std::span<const Fault> campaign_faults() { return faults; }

} // namespace dfdyn::tests
