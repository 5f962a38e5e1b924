// SPDX-License-Identifier: Apache-2.0
#include "tests/hal/campaign/arm.hpp"

#include <algorithm>
#include <bit>

namespace dfdyn::tests {

bool any(const Bits& bits) {
    return std::ranges::any_of(bits, [](std::uint8_t byte) { return byte != 0; });
}

int count(const Bits& bits) {
    int sum = 0;
    for (const std::uint8_t byte : bits) {
        sum += std::popcount(byte);
    }
    return sum;
}

void copy_bits(const hal::Frame& from, const Bits& bits, hal::Frame& to) {
    for (std::size_t i = 0; i < bits.size(); ++i) {
        to.data[i] = static_cast<std::uint8_t>((to.data[i] & ~bits[i]) | (from.data[i] & bits[i]));
    }
}

static void mark_changes(const hal::Frame& one, const hal::Frame& other, Bits& bits) {
    for (std::size_t i = 0; i < bits.size(); ++i) {
        bits[i] = static_cast<std::uint8_t>(bits[i] | (one.data[i] ^ other.data[i]));
    }
}

bool CampaignArm::has_form(const hal::Frame& frame) const {
    const auto same = [&](const hal::Frame& sent) {
        return sent.id == frame.id && sent.length == frame.length && sent.extended == frame.extended &&
               sent.fd == frame.fd && sent.remote == frame.remote;
    };
    const auto any_of = [&](const wire::Frames& sent) {
        return std::any_of(sent.frame.begin(), sent.frame.begin() + static_cast<std::ptrdiff_t>(sent.count),
                           same);
    };
    bool has = std::ranges::any_of(status, same) || (wrench && any_of(wrench({})));
    for (std::size_t board = 0; board < boards; ++board) {
        has = has || any_of(frames(board, {}));
    }
    return has;
}

void CampaignArm::find_fields() {
    std::mt19937_64 engine(1);
    std::uniform_real_distribution<double> position(-1.9, 1.9), effort(-8, 8);
    for (std::size_t board = 0; board < boards; ++board) {
        for (int i = 0; i < 400; ++i) {
            const auto joint = static_cast<std::size_t>(i % 2);
            wire::Joints joints{};
            const wire::Frames rest = frames(board, joints);
            joints[joint].position_rad = position(engine);
            const wire::Frames moved = frames(board, joints);
            joints[joint].effort = effort(engine);
            const wire::Frames loaded = frames(board, joints);
            for (std::size_t part = 0; part < rest.count; ++part) {
                mark_changes(rest.frame[part], moved.frame[part], fields[board][part].position[joint]);
                mark_changes(moved.frame[part], loaded.frame[part], fields[board][part].effort[joint]);
            }
        }
    }
}

static void send(Traffic& traffic, hal::Frame frame, std::int64_t time_ns, Sent::Role role, std::size_t unit,
                 int cycle) {
    frame.stamp_ns = time_ns;
    traffic.push_back({.frame = frame, .true_ns = time_ns, .role = role, .unit = unit, .cycle = cycle});
}

void CampaignArm::send_joints(const Scene& scene, int cycle, Traffic& traffic) const {
    const std::int64_t now_ns = scene.cycle_ns(cycle);
    if (synchronous) {
        send(traffic, wire::frame(0x080, {}), now_ns, Sent::Role::sync, 0, cycle);
    }
    for (std::size_t board = 0; board < boards; ++board) {
        const std::int64_t phase_ns = (100 + 130 * static_cast<std::int64_t>(board)) * bus_us;
        const std::int64_t begin_ns = now_ns + phase_ns + (synchronous ? 150 * bus_us : 0);
        const double t = seconds_of(synchronous ? now_ns : begin_ns);
        wire::Joints joints;
        for (std::size_t i = 0; i < joints.size(); ++i) {
            joints[i] = {scene.truth.position(i, t), scene.truth.velocity(i, t),
                         scene.truth.effort(i, t) + scene.noise(2) * (efforts() ? output_step : 0)};
        }
        const wire::Frames sent = frames(board, joints);
        std::int64_t late_ns = scene.jitter();
        for (std::size_t part = 0; part < sent.count; ++part) {
            send(traffic, sent.frame[part], begin_ns + late_ns, Sent::Role::joints, board, cycle);
            traffic.back().part = part;
            traffic.back().shown = joints;
            late_ns = (late_ns + bus_jitter) / 2;
        }
    }
}

void CampaignArm::send_wrench(const Scene& scene, int cycle, Traffic& traffic) const {
    const std::int64_t measured_ns = scene.cycle_ns(cycle) + 600 * bus_us;
    wire::SixWords raw{};
    for (std::size_t k = 0; k < raw.size(); ++k) {
        raw[k] = std::llround(32768 * scene.truth.load(k, seconds_of(measured_ns)) + scene.noise(2));
    }
    const wire::Frames halves = wrench(raw);
    const std::int64_t first_ns = measured_ns + scene.jitter();
    for (std::size_t half = 0; half < halves.count; ++half) {
        const std::int64_t after_ns = 130 * bus_us * static_cast<std::int64_t>(half);
        send(traffic, halves.frame[half], first_ns + after_ns, Sent::Role::wrench, 0, cycle);
        traffic.back().part = half;
    }
}

Traffic CampaignArm::run(const Scene& scene, int cycles) const {
    Traffic traffic;
    for (int cycle = 0; cycle < cycles; ++cycle) {
        for (std::size_t i = 0; i < status.size() && cycle % 50 == 0; ++i) {
            send(traffic, status[i], scene.cycle_ns(cycle) + 20 * bus_us, Sent::Role::status, 0, cycle);
        }
        send_joints(scene, cycle, traffic);
        if (wrench) {
            send_wrench(scene, cycle, traffic);
        }
    }
    std::ranges::stable_sort(traffic, {}, &Sent::true_ns);
    return traffic;
}

} // namespace dfdyn::tests
