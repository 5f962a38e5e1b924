// SPDX-License-Identifier: Apache-2.0
// Logs in tests/data/can/devices, written by device_logs.py from the protocols' documents only.
#include "tests/tools/can/recognition/device_logs.hpp"
#include "tools/can/arm/bus_sampler.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <sstream>

namespace device_logs_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
namespace hal = dfdyn::hal;
using Catch::Matchers::ContainsSubstring;

constexpr double pi = std::numbers::pi;
constexpr double start_s = 1'700'000'000;

/// Motion of joint `k` (from 1), as in device_logs.py.
double angle(int k, double t) { return 0.3 * k - 0.5 + 0.4 * std::sin(pi * t + k); }
double speed(int k, double t) { return 0.4 * pi * std::cos(pi * t + k); }
double effort(int k, double t) { return (0.5 + 0.1 * k) * std::cos(0.5 * pi * t + k); }

/// A log, and the largest error of its values: a count of the device with the lowest resolution.
struct DeviceLog {
    const char* name;
    const char* family;
    int joints;
    double angle_step, speed_step, effort_step;
};
constexpr std::array<DeviceLog, 9> logs{{
    {"damiao", "damiao", 3, 25.0 / 65535, 90.0 / 4095, 108.0 / 4095},
    {"robstride", "robstride", 3, 8 * pi / 65535, 100.0 / 65535, 34.0 / 65535},
    {"robstride_mit", "robstride", 3, 8 * pi / 65535, 100.0 / 4095, 34.0 / 4095},
    {"cubemars_mit", "cubemars", 2, 25.0 / 65535, 100.0 / 4095, 36.0 / 4095},
    {"cubemars_servo", "cubemars", 2, 0.1 * pi / 180, 0.006, 0.01},
    {"rmd", "rmd", 3, 0.01 * pi / 180, pi / 180, 0.01},
    {"rmd_v2", "rmd", 2, 0.01 * pi / 180, pi / 180, 33.0 / 2048},
    {"moteus", "moteus", 3, 2e-4 * pi, 5e-4 * pi, 0.01},
    {"piper", "piper", 6, 0.001 * pi / 180, 0.001, 0.001},
}};

BusDescription description_of(const DeviceLog& log) {
    return read_bus_description(device_folder + log.name + ".json");
}

const DeviceLog& log_named(std::string_view name) { return *std::ranges::find(logs, name, &DeviceLog::name); }

double time_of(const hal::Frame& frame) { return 1e-9 * static_cast<double>(frame.stamp_ns) - start_s; }

/// Number of compared values, and of wrong ones.
struct Compared {
    int positions = 0, velocities = 0, efforts = 0, wrong = 0, refused = 0;
};

Compared compare(std::vector<BusBoard> boards, const Frames& frames, const DeviceLog& log) {
    Compared compared;
    constexpr double tolerance = 1.01; // counts; makers truncate codes instead of rounding
    for (const hal::Frame& frame : frames) {
        for (BusBoard& board : boards) {
            const hal::Decoded decoded = board.board.decode(frame);
            compared.wrong += decoded.kind == hal::Decoded::Kind::rejected ? 1 : 0;
            for (int i = 0; i < decoded.joints; ++i) {
                const hal::JointValue& value = decoded.joint.at(static_cast<std::size_t>(i));
                const int k = value.joint + 1;
                const double t = time_of(frame);
                const auto judge = [&](double found, double expected, double step, int& count) {
                    ++count;
                    compared.wrong += std::abs(found - expected) > tolerance * step ? 1 : 0;
                };
                if (value.position_reason == hal::Reason::ok) {
                    judge(value.position_rad, angle(k, t), log.angle_step, compared.positions);
                }
                if (value.has_velocity) {
                    judge(value.velocity, speed(k, t), log.speed_step, compared.velocities);
                }
                if (value.effort_reason == hal::Reason::ok) {
                    judge(value.effort, effort(k, t), log.effort_step, compared.efforts);
                }
                compared.refused += hal::is_fault(value.position_reason) ? 1 : 0;
                compared.refused += hal::is_fault(value.effort_reason) ? 1 : 0;
            }
        }
    }
    return compared;
}

TEST_CASE("logs of motors by an independent encoder are decoded to within a count") {
    for (const DeviceLog& log : logs) {
        CAPTURE(log.name);
        const Compared compared = compare(description_of(log).boards, log_of(log.name), log);
        CHECK(compared.positions == 300 * log.joints);
        CHECK(compared.velocities == 300 * log.joints);
        CHECK(compared.efforts == 300 * log.joints);
        CHECK(compared.wrong == 0);
        CHECK(compared.refused == 0);
    }
}

TEST_CASE("a replay of these logs has a sample per period with the positions at its time") {
    for (const DeviceLog& log : logs) {
        CAPTURE(log.name);
        int valid = 0;
        int outputs = 0; // slow efforts repeat their coarse codes, and are partly taken for frozen
        double largest_error = 0;
        BusSampler sampler(description_of(log), [&](const BusSample& sample) {
            valid += sample.valid() ? 1 : 0;
            outputs += sample.sample.output_valid ? 1 : 0;
            for (int k = 1; sample.valid() && k <= log.joints; ++k) {
                const double t = 1e-9 * static_cast<double>(sample.sample.time_ns) - start_s;
                largest_error =
                    std::max(largest_error,
                             std::abs(sample.positions()[static_cast<std::size_t>(k - 1)] - angle(k, t)));
            }
        });
        for (const hal::Frame& frame : log_of(log.name)) {
            sampler.take(frame, hal::BusState::active, {});
        }
        sampler.finish();
        CHECK(valid > 280);
        CHECK(outputs > 250);
        CHECK(largest_error < log.angle_step + 2e-4); // interpolated over 5 ms
    }
}

TEST_CASE("a bus without a description is recognised and its draft decodes it") {
    for (const DeviceLog& log : logs) {
        CAPTURE(log.name);
        const Frames frames = log_of(log.name);
        const RecognisedBus bus = recognise_bus(frames);
        REQUIRE(bus.families.size() == 1);
        CHECK(bus.families[0].family->name == log.family);
        CAPTURE(bus.draft_error);
        REQUIRE(bus.draft);
        const BusDescription draft = parse_bus_description(*bus.draft, "the draft");
        CHECK(draft.joint_count == log.joints);
        CHECK(draft.joints.rate_hz == Approx(200));
        DeviceLog coarse = log;
        coarse.effort_step = 1e9;             // torque maxima may be uncertain
        coarse.speed_step += 0.04 * 0.4 * pi; // velocity maxima and gears are measured
        const Compared compared = compare(draft.boards, frames, coarse);
        CHECK(compared.positions == 300 * log.joints);
        CHECK(compared.wrong == 0);
        std::ostringstream out;
        print_recognised_bus(out, bus);
        CHECK_THAT(out.str(), ContainsSubstring(log.family));
    }
}

TEST_CASE("buscheck has no finding on these buses with their descriptions") {
    for (const DeviceLog& log : logs) {
        CAPTURE(log.name);
        const Names found = rules(description_of(log), log_of(log.name));
        const bool two_hosts = std::string(log.name) == "moteus"; // a second host gets replies, too
        CHECK(found == (two_hosts ? Names{"two_hosts"} : Names{}));
    }
}

/// The Damiao log with a change of the feedback of motor 2.
Frames damiao_with(const std::function<void(Frame&)>& change) {
    return changed(log_of("damiao"), [&](Frame& frame) {
        if (frame.id == 0x12 && frame.data[0] == 0x12) {
            change(frame);
        }
    });
}

unsigned velocity_code(const Frame& frame) { return frame.data[3] * 16U + frame.data[4] / 16U; }

void set_velocity_code(Frame& frame, unsigned code) {
    frame.data[3] = static_cast<std::uint8_t>(code >> 4U);
    frame.data[4] = static_cast<std::uint8_t>((code & 15U) << 4U | (frame.data[4] & 15U));
}

TEST_CASE("boards with other protocols are recognised, without a draft if it is uncertain") {
    const auto recognised = [](const BusDescription& arm) {
        const RecognisedBus bus = recognise_bus(sound(arm, 1));
        return bus.families.size() == 1 && bus.families[0].family->name == arm.joint_family->name
                   ? bus.families[0].recognition.boards.size()
                   : 0;
    };
    CHECK(recognised(drives()) == 6);
    CHECK(recognised(icub()) == 2);
    CHECK(recognised(described(odrive_and_ati)) == 2);
    CHECK(recognised(described(foc_and_robotous)) == 2);
    CHECK_FALSE(recognise_bus(sound(drives(), 1)).draft);
}

TEST_CASE("faults of motors are reported on a bus without a description") {
    CHECK(rules_without_description(log_of("damiao")) == Names{});
    CHECK(rules_without_description(damiao_with([](Frame& frame) {
              set_velocity_code(frame, 4095 - velocity_code(frame)); // the other direction
          })) == Names{"velocity_sign"});
    CHECK(rules_without_description(damiao_with([](Frame& frame) {
              frame.data[1] = 0x90;
              frame.data[2] = 0x12;
          })).contains("encoder_frozen"));
    CHECK(rules_without_description(damiao_with([](Frame& frame) { frame.data[0] = 0xC2; })) ==
          Names{"device_fault"}); // coil too hot
    CHECK(rules_without_description(without(log_of("damiao"), [](const Frame& frame) {
              return frame.id == 0x12;
          })) == Names{"silent_motor"});
    CHECK(rules_without_description(without(
              log_of("rmd"), [](const Frame& frame) { return frame.id == 0x243; })) == Names{"silent_motor"});
}

TEST_CASE("a few frames like those of another RMD motor do not change the position of the draft") {
    Frames frames = log_of("rmd");
    for (const std::size_t quarter : {1U, 2U, 3U}) {
        Frame other = hal::make_frame(0x25C, 8); // motor 28, too few answers to recognise it
        other.data[0] = 0x9C;
        other.stamp_ns = frames[quarter * frames.size() / 4].stamp_ns;
        frames.push_back(other);
    }
    std::ranges::stable_sort(frames, {}, &Frame::stamp_ns);
    const RecognisedBus bus = recognise_bus(frames);
    REQUIRE(bus.draft);
    CHECK(bus.draft->at("joints").at("position") == "multi_turn");
}

TEST_CASE(
    "a Damiao motor's velocity maximum is measured where libraries disagree and registers are not read") {
    const Frames unread = without(log_of("damiao"), [](const Frame& frame) {
        return frame.id == 0x7FF || (frame.id > 0x10 && frame.data[0] < 0x10);
    });
    for (const double maximum : {10.0, 8.0}) {
        // the same velocities in the codes of another maximum
        const Frames frames = changed(unread, [&](Frame& frame) {
            if (frame.id == 0x12) {
                const double velocity = velocity_code(frame) / 4095.0 * 20 - 10;
                set_velocity_code(frame, static_cast<unsigned>((velocity + maximum) / (2 * maximum) * 4095));
            }
        });
        const RecognisedBus bus = recognise_bus(frames);
        REQUIRE(bus.draft);
        const auto& board = bus.draft->at("joints").at("boards").at(1);
        CHECK(board.at("velocity_max").get<double>() == maximum);
        CHECK(board.at("torque_max").get<double>() == 28);
    }
}

TEST_CASE("a program that polls a motor by clearing its faults is reported") {
    Frames frames = log_of("robstride_mit");
    const std::size_t sent = frames.size();
    for (std::size_t i = 0; i < sent; i += 30) {
        Frame clear = hal::make_frame(2, 8);
        clear.data.fill(0);
        std::fill_n(clear.data.begin(), 7, std::uint8_t{0xFF});
        clear.data[7] = 0xFB;
        clear.stamp_ns = frames[i].stamp_ns + 20'000;
        frames.push_back(clear);
    }
    std::ranges::stable_sort(frames, {}, &Frame::stamp_ns);
    CHECK(rules_without_description(frames) == Names{"faults_cleared"});
    CHECK(rules(description_of(log_named("robstride_mit")), frames) == Names{"faults_cleared"});
}

TEST_CASE("old firmware and the second arm on a bus of Pipers are recognised") {
    const Frames rpm = changed(log_of("piper"), [](Frame& frame) {
        if (frame.id > 0x250 && frame.id <= 0x256) {
            const double rad_s = 0.001 * hal::load_big<std::int16_t>(frame.data.data());
            hal::store_big(frame.data.data(), static_cast<std::int16_t>(std::lround(rad_s * 30 / pi)));
        }
    });
    const RecognisedBus old = recognise_bus(rpm);
    REQUIRE(old.draft);
    CHECK(old.draft->at("joints").at("firmware") == "rpm");
    CHECK(rules(description_of(log_named("piper")), rpm) == Names{"velocity_scale"});
    Frames two = log_of("piper");
    for (Frame frame : log_of("piper")) {
        if (frame.id >= 0x2A1 && frame.id <= 0x2A8) {
            frame.id += 0x10;
            frame.stamp_ns += 50'000;
            two.push_back(frame);
        }
    }
    std::ranges::stable_sort(two, {}, &Frame::stamp_ns);
    std::ostringstream out;
    print_recognised_bus(out, recognise_bus(two));
    CHECK_THAT(out.str(), ContainsSubstring("2 arms are on this bus"));
}

} // namespace device_logs_test
