// SPDX-License-Identifier: Apache-2.0
// Signals that resemble a fault of another kind, or no fault, are not reported as such.
#include "tests/tools/can/bus_check_support.hpp"
#include "tests/tools/can/example_arms.hpp"
#include "tools/can/check/position_jumps.hpp"
#include "tools/can/check/sequence_watch.hpp"

#include <numbers>

namespace bus_check_near_fault_test {

using namespace dfdyn::tests;
using Catch::Matchers::ContainsSubstring;
namespace hal = dfdyn::hal;

/// Drives that measure at a SYNC, and a sensor that does not.
BusDescription drives_with_sensor() {
    const auto& joints = dfdyn::tools::joint_families();
    const auto& sensors = dfdyn::tools::sensor_families();
    const auto drive = std::ranges::find(joints, "cia402", &dfdyn::tools::JointFamily::name);
    const auto sensor = std::ranges::find(sensors, "ati_netcan", &dfdyn::tools::SensorFamily::name);
    return example_arm(*drive, sensor->example);
}

std::string evidence(const BusCheck& check, const std::string& rule) {
    for (const dfdyn::tools::BusFinding& finding : bus_findings(check)) {
        if (finding.rule == rule) {
            return finding.evidence;
        }
    }
    return "";
}

TEST_CASE("buscheck reports nothing for a sensor with its own clock on a bus with a SYNC") {
    const BusDescription bus = drives_with_sensor();
    const BusCheck check(bus);
    CHECK(rules(bus, changed(sound(bus), [&](Frame& frame) {
                    const auto stream = check.streams().find({frame.extended, frame.id});
                    if (stream != check.streams().end() && stream->second.sender == "sensor") {
                        frame.stamp_ns += frame.stamp_ns / 2000; // 500 ppm: a period in 4 s
                    }
                })) == Names{});
}

TEST_CASE("buscheck does not report answers just before and after a SYNC as late") {
    dfdyn::tools::SyncAnswers answers;
    for (int i = 0; i < 200; ++i) {
        answers.take(i % 2 == 0 ? 100'000 : 1'900'000, 2e6);
    }
    CHECK(answers.late() == 0);
    for (int i = 0; i < 20; ++i) {
        answers.take(900'000, 2e6);
    }
    CHECK(answers.late() == 20);
}

TEST_CASE("buscheck reports stalls of the reader as gaps and not as a second sender") {
    for (const BusDescription& bus : {drives_with_sensor(), described(foc_and_robotous)}) {
        for (const std::int64_t stall_ns : {30'000'000, 60'000'000}) {
            const Frames frames = sound(bus);
            const std::int64_t begin_ns = frames[frames.size() / 2].stamp_ns, end_ns = begin_ns + stall_ns;
            std::int64_t read_ns = end_ns;
            CAPTURE(bus.joint_family->name, stall_ns);
            CHECK(rules(bus, changed(frames, [&](Frame& frame) {
                            if (frame.stamp_ns > begin_ns && frame.stamp_ns < end_ns) {
                                frame.stamp_ns = read_ns += 200;
                            }
                        })) == Names{"gaps"});
        }
    }
}

TEST_CASE("buscheck prints the number of late frames") {
    const BusDescription bus = described(foc_and_robotous);
    int count = 0;
    const BusCheck check = checked(bus, changed(sound(bus), [&](Frame& frame) {
                                       frame.stamp_ns +=
                                           frame.id == 0x110 && ++count % 100 == 0 ? 1'000'000 : 0;
                                   }));
    CHECK_THAT(evidence(check, "late_frames"), ContainsSubstring("more than 40 % of 2 ms off"));
}

/// Positions of joint 1 of `drives`, in counts, as `counts` returns them for a time in s.
Frames with_positions(const Frames& frames, const std::function<std::int32_t(double, std::int32_t)>& counts) {
    return changed(frames, [&](Frame& frame) {
        if (frame.id == 0x281) {
            const auto now = hal::load_little<std::int32_t>(frame.data.data());
            hal::store_little(frame.data.data(), counts(1e-9 * static_cast<double>(frame.stamp_ns), now));
        }
    });
}

constexpr std::int32_t turn_counts = 1'048'576; ///< of the encoders of `drives`

TEST_CASE("buscheck reports a frozen encoder despite a few duplicated frames") {
    const BusDescription bus = drives_with_sensor();
    std::optional<std::int32_t> last;
    Frames frames = with_positions(sound(bus, 14), [&](double time_s, std::int32_t now) {
        return time_s > 0.2 && time_s < 1.8 ? *(last = last.value_or(now)) : now;
    });
    const auto copy = [&](std::size_t after) {
        const auto found =
            std::find_if(frames.begin() + static_cast<std::ptrdiff_t>(after * frames.size() / 4),
                         frames.end(), [](const Frame& frame) { return frame.id == 0x281; });
        Frame again = *found;
        again.stamp_ns += 100'000;
        frames.push_back(again);
        std::ranges::stable_sort(frames, {}, &Frame::stamp_ns);
    };
    copy(1), copy(2), copy(3);
    CHECK(rules(bus, frames) == Names{"encoder_frozen"});
}

TEST_CASE("buscheck distinguishes an unsigned encoder that wraps from one that lost its zero") {
    const BusDescription bus = drives();
    const auto wrapping = [](double time_s, std::int32_t) {
        return static_cast<std::int32_t>(-40'000 + std::llround(20'000 * time_s) + turn_counts) % turn_counts;
    };
    CHECK(rules(bus, with_positions(sound(bus), wrapping)) == Names{"position_wrap"});
}

/// Number of a SYNC; there are 125 a second.
std::int32_t sync_at(double time_s) { return static_cast<std::int32_t>(std::lround(125 * time_s)); }

/// The same bus with an absolute encoder at joint 1.
BusDescription absolute_drives() {
    BusDescription bus = drives();
    bus.joint_limits.front().encoder = hal::Encoder::absolute;
    return bus;
}

TEST_CASE("buscheck reports a lost zero after a silence unless the encoder is absolute") {
    // The joint is 2,000 counts from its zero before a silence of 0.2 s, and at the zero after it.
    const auto passes_zero = [](double time_s, std::int32_t) {
        const std::int32_t sync = sync_at(time_s);
        return 80 * (250 - sync);
    };
    Frames frames = with_positions(sound(drives()), passes_zero);
    const std::int64_t begin_ns = frames.front().stamp_ns;
    frames = without(frames, [&](const Frame& frame) {
        const double time_s = 1e-9 * static_cast<double>(frame.stamp_ns - begin_ns);
        return frame.id == 0x281 && time_s > 1.801 && time_s < 1.999;
    });
    CHECK(rules(drives(), frames) == Names{"gaps", "zero_lost"});
    CHECK(rules(absolute_drives(), frames) == Names{"gaps"});
}

TEST_CASE("buscheck reports a jump to the encoder's zero as a lost zero unless the encoder is absolute") {
    const auto jumps_to_zero = [](double time_s, std::int32_t) {
        const std::int32_t sync = sync_at(time_s);
        return (sync < 250 ? 200'123 : 0) + 80 * (sync - 250);
    };
    const Frames frames = with_positions(sound(drives()), jumps_to_zero);
    CHECK(rules(drives(), frames) == Names{"zero_lost"});
    CHECK(rules(absolute_drives(), frames) == Names{"position_jump"});
}

TEST_CASE("zeros of an absolute encoder remain zeros while its joint passes the zero") {
    const auto drops_out = [](double time_s, std::int32_t) {
        const std::int32_t sync = sync_at(time_s);
        return sync >= 240 && sync < 250 ? 0 : 123 + 2000 * (250 - sync);
    };
    const Frames frames = with_positions(sound(drives()), drops_out);
    CHECK(rules(drives(), frames) == Names{"zero_lost"});
    CHECK(rules(absolute_drives(), frames) == Names{"position_zeros"});
}

TEST_CASE("buscheck distinguishes a joint at rest at the wrap of its encoder from flipped bits") {
    const BusDescription bus = drives();
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<double> noise(0, 30);
    const BusCheck check = checked(bus, with_positions(sound(bus, 8), [&](double, std::int32_t) {
                                       const auto counts = static_cast<std::int32_t>(noise(engine));
                                       return (counts + turn_counts) % turn_counts;
                                   }));
    CHECK(rules_of(check) == Names{"position_wrap"});
    CHECK_THAT(evidence(check, "position_wrap"), ContainsSubstring("at least 64 of "));
}

TEST_CASE("buscheck does not assign a foreign device with 29-bit identifiers to the arm") {
    const BusDescription bus = drives();
    Frames frames = sound(bus);
    const std::size_t count = frames.size();
    for (std::size_t i = 0; i < count; ++i) {
        if (frames[i].id == 0x281) {
            frames.push_back(hal::make_frame(0x281, 4));
            frames.back().extended = true;
            frames.back().stamp_ns = frames[i].stamp_ns + 700'000;
        }
    }
    CHECK(rules(bus, changed(frames, [](Frame&) {})) == Names{});
    const Frames instead = changed(sound(bus), [](Frame& frame) { frame.extended = frame.id == 0x281; });
    CHECK(rules(bus, instead) == Names{"rejected_frames"});
    int number = 0;
    CHECK(rules(bus, changed(sound(bus), [&](Frame& frame) {
                    frame.extended = frame.id == 0x281 && ++number % 100 == 0;
                })) == Names{"lost_frames", "rejected_frames"});
}

TEST_CASE("buscheck reports lost frames of a joint despite wrong time stamps of another source") {
    const BusDescription bus = drives_with_sensor();
    const Frames good = sound(bus);
    int lost = 0, strays = 0;
    Frames frames = without(good, [&](const Frame& frame) { return frame.id == 0x281 && ++lost % 100 == 0; });
    for (Frame& frame : frames) {
        if (frame.id == 0x282 && ++strays % 30 == 0) {
            frame.stamp_ns -= 3'600'000'000'000;
        }
    }
    CHECK(rules(bus, frames) == Names{"lost_frames", "clock_jumped"});
}

TEST_CASE("buscheck reports late frames of a joint despite other frames read out of order") {
    const BusDescription bus = described(foc_and_robotous);
    int late = 0;
    Frames frames = changed(sound(bus), [&](Frame& frame) {
        frame.stamp_ns += frame.id == 0x110 && ++late % 100 == 0 ? 1'000'000 : 0;
    });
    for (const std::size_t quarter : {1U, 2U, 3U}) {
        std::size_t at = quarter * frames.size() / 4;
        while (frames[at].id == 0x110 || frames[at + 1].id == 0x110 || frames[at].id == frames[at + 1].id) {
            ++at;
        }
        std::swap(frames[at], frames[at + 1]);
    }
    CHECK(rules(bus, frames) == Names{"frames_overtaken", "late_frames"});
}

TEST_CASE("buscheck does not report two consecutive wrong stamps as a silence") {
    const BusDescription bus = drives();
    Frames frames = sound(bus);
    frames[frames.size() / 2].stamp_ns += 40'000'000;
    frames[frames.size() / 2 + 1].stamp_ns += 700'000'000;
    CHECK(rules(bus, frames) == Names{"clock_jumped"});
}

TEST_CASE("buscheck reports the pause of a source with many wrong time stamps") {
    const BusDescription bus = drives();
    int number = 0;
    Frames frames = without(sound(bus), [&](const Frame& frame) {
        number += frame.id == 0x281 ? 1 : 0;
        return frame.id == 0x281 && number > 200 && number <= 215;
    });
    int strays = 0;
    for (Frame& frame : frames) {
        if (frame.id == 0x281 && ++strays % 25 == 0) {
            frame.stamp_ns -= 3'600'000'000'000;
        }
    }
    CHECK(rules(bus, frames) == Names{"clock_jumped", "gaps"});
}

TEST_CASE("buscheck does not report flipped bits of a joint at rest as a frozen encoder") {
    const BusDescription bus = drives();
    int number = 0;
    const Frames frames = with_positions(
        sound(bus), [&](double, std::int32_t) { return 1000 + (++number % 300 == 0 ? 1 << 16 : 0); });
    CHECK(rules(bus, frames) == Names{"bits_flipped"});
}

TEST_CASE("buscheck reports a babbling node, whenever it begins") {
    const BusDescription bus = drives();
    for (const double begin_s : {1.0, 1.05, 1.1, 1.15}) {
        CAPTURE(begin_s);
        Frames frames = sound(bus);
        for (int i = 0; i < 500; ++i) { // 0.2 s, 33 % of the bit rate
            frames.push_back(hal::make_frame(0x7A0, 8));
            frames.back().stamp_ns = frames.front().stamp_ns + std::llround(1e9 * begin_s) + i * 400'000;
        }
        CHECK(rules(bus, changed(frames, [](Frame&) {})).count("unknown_traffic") == 1);
    }
}

} // namespace bus_check_near_fault_test
