// SPDX-License-Identifier: Apache-2.0
#include "tests/hal/campaign/fault_actions.hpp"

namespace dfdyn::tests {

using Role = Sent::Role;

void lose_frames(FaultSite& site) {
    site.remove([&](const Sent& sent) { return FaultSite::is_device(sent) && site.chance(0.2); });
}
void lose_cycles(FaultSite& site) {
    site.remove([](const Sent& sent) { return FaultSite::is_device(sent); });
}
void silence_board(FaultSite& site) {
    const std::size_t joint = site.pick_joint();
    site.remove([&](const Sent& sent) { return site.is_joint(sent, joint); });
}
void silence_sensor(FaultSite& site) {
    site.remove([](const Sent& sent) { return sent.role == Role::wrench; });
}

void delay_frames(FaultSite& site) {
    site.change([&](Sent& sent) {
        if (FaultSite::is_device(sent) && site.chance(0.1)) {
            move(sent, std::int64_t{bus_us} * site.pick(2400));
        }
    });
    site.sort();
}
void duplicate_frames(FaultSite& site) {
    site.add([&](const Sent& sent, Traffic& more) {
        if (FaultSite::is_device(sent) && site.chance(0.2)) {
            more.push_back(sent);
            move(more.back(), std::int64_t{bus_us} * (50 + site.pick(2150)));
        }
    });
}
/// Delivers frames in a different order than that of their stamps.
void swap_frames(FaultSite& site) {
    for (std::size_t i = 1; i < site.traffic.size(); ++i) {
        if (site.covers(site.traffic[i]) && FaultSite::is_device(site.traffic[i]) && site.chance(0.2)) {
            std::swap(site.traffic[i - 1].true_ns, site.traffic[i].true_ns);
        }
    }
    site.sort();
}
/// Flips bits of positions and wrenches; efforts may step.
void corrupt_bits(FaultSite& site) {
    site.change([&](Sent& sent) {
        if (FaultSite::is_device(sent) && sent.frame.length > 0 && site.chance(0.1)) {
            const auto bit = static_cast<std::size_t>(site.pick(8 * sent.frame.length));
            const auto mask = static_cast<std::uint8_t>(1U << bit % 8);
            const bool of_effort = sent.role == Role::joints &&
                                   std::ranges::any_of(site.fields(sent).effort, [&](const Bits& effort) {
                                       return (effort[bit / 8] & mask) != 0;
                                   });
            sent.frame.data[bit / 8] ^= of_effort ? std::uint8_t{0} : mask;
            sent.corrupted = true;
        }
    });
}

static void stray_stamp(FaultSite& site, std::int64_t sign) {
    constexpr std::array<std::int64_t, 4> sizes{3'000'000, 40'000'000, 700'000'000, 3'600'000'000'000};
    auto left = 1 + site.pick(8); // more and fewer than a sampler drops in a row
    site.change([&](Sent& sent) {
        if (left > 0 && site.chance(0.05)) {
            sent.frame.stamp_ns += sign * sizes[static_cast<std::size_t>(site.pick(4))];
            --left;
        }
    });
}
void stamp_ahead(FaultSite& site) { stray_stamp(site, 1); }
void stamp_behind(FaultSite& site) { stray_stamp(site, -1); }
static void set_clock(const FaultSite& site, std::int64_t by_ns) {
    for (Sent& sent : site.traffic) {
        const std::int64_t mine_ns = sent.true_ns >= site.begin_ns ? by_ns : 0;
        sent.frame.stamp_ns += mine_ns;
        sent.clock_ns += mine_ns;
    }
}
void clock_back(FaultSite& site) { set_clock(site, -std::int64_t{1'000'000} * (50 + site.pick(9'000))); }
void clock_forward(FaultSite& site) { set_clock(site, std::int64_t{1'000'000} * (50 + site.pick(9'000))); }
void clock_slightly(FaultSite& site) {
    set_clock(site, std::int64_t{bus_us} * (1500 + site.pick(2500)) * (site.chance(0.5) ? 1 : -1));
}

static hal::Frame error_frame(std::uint32_t classes, std::int64_t stamp_ns) {
    hal::Frame frame = wire::frame(classes, {0, 0, 0, 0, 0, 0, 0, 0});
    frame.error = true;
    frame.stamp_ns = stamp_ns;
    return frame;
}
void bus_off(FaultSite& site) {
    std::int64_t clock_ns = 0; // error of the stamps' clock
    site.change([&](const Sent& sent) { clock_ns = sent.clock_ns; });
    site.remove([](const Sent&) { return true; });
    for (const auto& [classes, time_ns] : {std::pair{0x040U, site.begin_ns}, {0x100U, site.end_ns}}) {
        site.traffic.push_back(
            {.frame = error_frame(classes, time_ns + clock_ns), .true_ns = time_ns, .clock_ns = clock_ns});
    }
    site.sort();
}

void lose_syncs(FaultSite& site) {
    site.remove([&](const Sent& sent) { return sent.role == Role::sync && site.chance(0.3); });
}
/// Delays the answers more and more, until they come after the next SYNC.
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
/// Adds frames of other devices to the bus.
void add_other_traffic(FaultSite& site) {
    std::uniform_real_distribution<double> load(0.7, 1.15);
    const double others = load(site.engine);
    Traffic dummy;
    std::int64_t clock_ns = 0; // error of the stamps' clock
    site.change([&](const Sent& sent) { clock_ns = sent.clock_ns; });
    for (std::int64_t t = site.begin_ns; t < site.end_ns; t += 130 * bus_us) {
        if (site.chance(others * 0.8)) {
            dummy.push_back({.frame = wire::frame(site.chance(0.7) ? 0x0F0 : 0x7F0, {1, 2, 3, 4, 5, 6, 7, 8}),
                             .true_ns = t});
            dummy.back().frame.stamp_ns = t + clock_ns;
            dummy.back().clock_ns = clock_ns;
        }
    }
    site.traffic.insert(site.traffic.end(), dummy.begin(), dummy.end());
    site.sort();
}

/// Simulates arbitration: one frame at a time, the lowest identifier first.
class Arbitration {
  public:
    explicit Arbitration(std::int64_t free_ns) : free_ns_(free_ns) {}

    void wait(const Sent& sent) { queue_.push_back(sent); }
    void serve_until(std::int64_t time_ns) {
        while (!queue_.empty() && free_ns_ < time_ns) {
            const auto first =
                std::ranges::min_element(queue_, {}, [](const Sent& sent) { return sent.frame.id; });
            free_ns_ += 125 * bus_us;
            move(*first, free_ns_ - first->true_ns);
            sent_.push_back(*first);
            queue_.erase(first);
        }
        free_ns_ = std::max(free_ns_, time_ns);
    }
    Traffic sent() && { return std::move(sent_); }

  private:
    std::int64_t free_ns_;
    Traffic queue_, sent_;
};

void overload(FaultSite& site) {
    add_other_traffic(site);
    Arbitration bus(site.begin_ns);
    // SYNCs are not delayed, because a drive measures when it receives one.
    const auto waits = [](const Sent& sent) { return sent.role != Role::sync; };
    for (const Sent& sent : site.traffic) {
        if (site.covers(sent) && waits(sent)) {
            bus.serve_until(sent.true_ns - 125 * bus_us);
            bus.wait(sent);
        }
    }
    bus.serve_until(site.end_ns + 200 * bus_period);
    Traffic done = std::move(bus).sent();
    site.remove(waits);
    std::erase_if(done, [&](const Sent& sent) { return sent.true_ns >= site.end_ns; });
    site.traffic.insert(site.traffic.end(), done.begin(), done.end());
    site.sort();
}

static void set_length(hal::Frame& frame, int length) {
    frame.length = static_cast<std::uint8_t>(length);
    std::fill(frame.data.begin() + length, frame.data.end(), std::uint8_t{0});
}

void malform(FaultSite& site) {
    site.change([&](Sent& sent) {
        if (!FaultSite::is_device(sent) || !site.chance(0.1)) {
            return;
        }
        sent.role = Role::noise; // for faults that are applied afterwards
        const hal::Frame sound = sent.frame;
        switch (site.pick(4)) {
        case 0:
            set_length(sent.frame, (sent.frame.length + 1 + site.pick(7)) % 9);
            break;
        case 1:
            sent.frame.remote = true;
            break;
        case 2:
            sent.other_form = true;
            sent.frame.fd = !sent.frame.fd;
            break;
        default:
            sent.other_form = true;
            sent.frame.extended = !sent.frame.extended;
            sent.frame.id &= 0x7FFU;
            break;
        }
        if (site.arm.has_form(sent.frame)) { // some devices have several frame formats
            sent.frame = sound;
            sent.frame.remote = true;
        }
    });
}
void babble(FaultSite& site) {
    site.add([&](const Sent& sent, Traffic& more) {
        for (int i = 0; i < 3; ++i) {
            hal::Frame frame =
                wire::frame(static_cast<std::uint32_t>(0x700 + site.pick(0xFF)), {1, 2, 3, 4, 5, 6, 7, 8});
            frame.stamp_ns = sent.frame.stamp_ns;
            more.push_back({.frame = frame, .true_ns = sent.true_ns, .clock_ns = sent.clock_ns});
        }
    });
}

} // namespace dfdyn::tests
