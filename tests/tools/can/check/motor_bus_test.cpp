// SPDX-License-Identifier: Apache-2.0
// Buses of motors: what programs send to them is no fault, and a motor without answers is named. The logs are
// by an independent encoder (tests/data/can/devices).
#include "tests/tools/can/recognition/device_logs.hpp"

namespace motor_bus_test {

using namespace dfdyn::tests;
using Catch::Matchers::ContainsSubstring;
using dfdyn::tools::BusFinding;
namespace hal = dfdyn::hal;

constexpr std::int64_t us = 1000;
constexpr std::int64_t ms = 1'000'000;

BusDescription bus_of(const std::string& name) {
    return dfdyn::tools::read_bus_description(device_folder + name + ".json");
}

Frame frame_at(std::uint32_t id, std::initializer_list<std::uint8_t> bytes, std::int64_t stamp_ns,
               bool extended = false) {
    Frame frame = hal::make_frame(id, static_cast<int>(bytes.size()));
    std::ranges::copy(bytes, frame.data.begin());
    frame.stamp_ns = stamp_ns;
    frame.extended = extended;
    return frame;
}

/// Returns the frames with further ones, in order of time.
Frames with_all(Frames frames, const Frames& others) {
    frames.insert(frames.end(), others.begin(), others.end());
    return changed(std::move(frames), [](Frame&) {});
}

/// Returns a frame `make(stamp_ns)` every `period_ns` of the log.
Frames every(std::int64_t period_ns, const Frames& log, const std::function<Frame(std::int64_t)>& make) {
    Frames frames;
    for (std::int64_t at = log.front().stamp_ns + period_ns; at < log.back().stamp_ns; at += period_ns) {
        frames.push_back(make(at));
    }
    return frames;
}

/// Returns a frame `make(frame)` for each frame of the log that `is_one`.
Frames frames_from(const Frames& log, const std::function<bool(const Frame&)>& is_one,
                   const std::function<Frame(const Frame&)>& make) {
    Frames frames;
    for (const Frame& frame : log) {
        if (is_one(frame)) {
            frames.push_back(make(frame));
        }
    }
    return frames;
}

BusFinding only_finding(const BusDescription& bus, const Frames& frames) {
    const std::vector<BusFinding> findings = bus_findings(checked(bus, frames));
    REQUIRE(findings.size() == 1);
    return findings.front();
}

BusDescription drives_with_heartbeat(const std::string& timeout_s) {
    std::string text = file_content(bus_folder + "ur5_cia402.json");
    const std::string family = "\"family\": \"cia402\",";
    text.insert(text.find(family) + family.size(), "\"heartbeat_timeout_s\": " + timeout_s + ",");
    return described(text);
}

TEST_CASE("a Robstride motor with a fault or in another mode is not reported as silent") {
    const BusDescription bus = bus_of("robstride");
    const Frames good = log_of("robstride");
    const auto of_motor_2 = [](const Frame& frame) {
        return frame.id >> 24 == 2 && (frame.id >> 8 & 255) == 2;
    };
    CHECK(rules(bus, changed(good, [&](Frame& frame) {
                    frame.id |= of_motor_2(frame) ? 1U << 18U : 0U; // too hot
                })) == Names{"device_fault"});
    const auto reset_from = [&](std::int64_t stamp_ns) {
        return changed(good, [&](Frame& frame) {
            frame.id &= of_motor_2(frame) && frame.stamp_ns >= stamp_ns ? ~(3U << 22U) : ~0U;
        });
    };
    CHECK(rules(bus, reset_from(0)) == Names{"not_operational"});
    const Frames later = reset_from(good[good.size() / 2].stamp_ns);
    CHECK(rules(bus, later) == Names{"not_operational"});
    const BusCheck check = checked(std::nullopt, later);
    std::vector<BusFinding> findings = bus_findings(check);
    CHECK(std::ranges::count(findings, "source_stopped", &BusFinding::rule) == 1);
    add_findings(dfdyn::tools::recognise_bus(later), check, findings);
    CHECK(std::ranges::count(findings, "source_stopped", &BusFinding::rule) == 0);
}

TEST_CASE("the remedy for a motor that is not operational is that of its family") {
    const Frames disabled = changed(log_of("damiao"), [](Frame& frame) {
        frame.data[0] = frame.id == 0x12 ? 2 : frame.data[0]; // state 0
    });
    const BusFinding finding = only_finding(bus_of("damiao"), disabled);
    CHECK(finding.rule == "not_operational");
    CHECK_THAT(finding.fix, ContainsSubstring("Enable the motor"));
    const auto is_heartbeat = [](const Frame& frame) { return frame.id > 0x700; };
    const BusDescription canopen = drives_with_heartbeat("0.25");
    const BusFinding other = only_finding(canopen, changed(sound(canopen), [&](Frame& frame) {
                                              frame.data[0] = is_heartbeat(frame) ? 0x7F : frame.data[0];
                                          }));
    CHECK(other.rule == "not_operational");
    CHECK_THAT(other.fix, ContainsSubstring("NMT start"));
}

TEST_CASE("an RMD motor that is commanded by currents and polled for its angle and status has no finding") {
    const BusDescription bus = bus_of("rmd");
    const Frames good = log_of("rmd");
    const auto is_angle = [](const Frame& frame) { return frame.id > 0x240 && frame.data[0] == 0x92; };
    const auto is_status = [](const Frame& frame) { return frame.id > 0x240 && frame.data[0] == 0x9C; };
    // 0xA1 is answered before 0x92 is; its answer is that to 0x9C
    const Frames commands = frames_from(good, is_angle, [](const Frame& angle) {
        return frame_at(angle.id - 0x100, {0xA1, 0, 0, 0, 10, 0, 0, 0}, angle.stamp_ns - 90 * us);
    });
    const Frames answers = frames_from(good, is_status, [](Frame status) {
        status.data[0] = 0xA1;
        status.stamp_ns -= 130 * us;
        return status;
    });
    const BusCheck check = checked(bus, with_all(with_all(good, commands), answers));
    CHECK(rules_of(check) == Names{});
    CHECK(check.samples().count(hal::Reason::id_collision) == 0);
    CHECK(check.samples().count(hal::Reason::ok) > 250);
}

TEST_CASE("an RMD motor may be polled for its angle by another program than the one that commands it") {
    const Frames good = log_of("rmd");
    const Frames commands = every(13'700 * us, good, [](std::int64_t at) {
        return frame_at(0x141, {0xA1, 0, 0, 0, 10, 0, 0, 0}, at);
    });
    CHECK(rules(bus_of("rmd"), with_all(good, commands)) == Names{});
}

TEST_CASE("commands to motors that answer on the identifier of their commands are not their frames") {
    const Frames answers = changed(log_of("cubemars_mit"), [](Frame& frame) { frame.id = frame.data[0]; });
    const auto all = [](const Frame&) { return true; };
    const Frames commands = frames_from(answers, all, [](const Frame& answer) {
        return frame_at(answer.id, {0x7F, 0xFF, 0x7F, 0xF0, 0, 0, 7, 0xFF}, answer.stamp_ns - 100 * us);
    });
    std::string text = file_content(device_folder + "cubemars_mit.json");
    for (const char* const number : {"1", "2"}) {
        const std::string field = std::string("\"motor_id\": ") + number;
        text.replace(text.find(field), field.size(), field + R"(, "feedback_id": "0x)" + number + "\"");
    }
    CHECK(rules(described(text), with_all(answers, commands)) == Names{});
}

Frame damiao_poll(std::int64_t at) { return frame_at(0x7FF, {1, 0, 0xCC, 0, 0, 0, 0, 0}, at); }

TEST_CASE("a program that polls and commands a motor in turn is distinguished from a second one that polls") {
    const BusDescription bus = bus_of("damiao");
    const Frames good = log_of("damiao");
    const auto is_command = [](const Frame& frame) { return frame.id == 1; };
    const Frames in_turn = frames_from(
        good, is_command, [](const Frame& command) { return damiao_poll(command.stamp_ns - 1300 * us); });
    CHECK(rules(bus, with_all(good, in_turn)) == Names{});
    CHECK(rules(bus, with_all(good, every(13'700 * us, good, damiao_poll))) ==
          Names{"polled_beside_commands"});
    CHECK(rules(bus, with_all(good, every(1'370 * us, good, damiao_poll))) ==
          Names{"polled_beside_commands"});
    CHECK(rules(bus, with_all(with_all(good, in_turn), every(13'700 * us, good, damiao_poll))) ==
          Names{"polled_beside_commands"});
}

TEST_CASE("a program that polls a motor only while it does not command it is not a second one") {
    const Frames good = log_of("damiao");
    const std::int64_t half_ns = good[good.size() / 2].stamp_ns;
    const Frames all = with_all(good, every(10 * ms, good, damiao_poll));
    const auto is_poll = [](const Frame& frame) { return frame.id == 0x7FF && frame.data[2] == 0xCC; };
    for (const bool polls_first : {true, false}) {
        CHECK(rules(bus_of("damiao"), without(all, [&](const Frame& frame) {
                        const bool polls = (frame.stamp_ns < half_ns) == polls_first;
                        return polls ? frame.id == 1 : is_poll(frame);
                    })) == Names{});
    }
}

TEST_CASE("a program that reads parameters of motors is not reported as a second one that polls") {
    const Frames damiao = log_of("damiao");
    const Frames reads = every(47 * ms, damiao, [](std::int64_t at) {
        return frame_at(0x7FF, {1, 0, 0x33, 0x16, 0, 0, 0, 0}, at);
    });
    CHECK(rules(bus_of("damiao"), with_all(damiao, reads)) == Names{});
    const Frames robstride = log_of("robstride");
    const auto command = [](std::int64_t at) { // type 1 with torque 0
        return frame_at(0x017F'FF01, {0x7F, 0xFF, 0x7F, 0xFF, 0, 0, 0, 0}, at, true);
    };
    const auto read = [](std::int64_t at) {
        return frame_at(0x1100'FD01, {0x19, 0x70, 0, 0, 0, 0, 0, 0}, at, true);
    };
    CHECK(rules(bus_of("robstride"), with_all(with_all(robstride, every(5 * ms, robstride, command)),
                                              every(47 * ms, robstride, read))) == Names{});
}

TEST_CASE("answers to a host are not commands to a motor with the number of the host") {
    CHECK_FALSE(rules_without_description(log_of("moteus")).contains("silent_motor"));
    const Frames good = log_of("robstride");
    const Frames values = every(47 * ms, good, [](std::int64_t at) { // type 17: of motor 1 to host 0xFD
        return frame_at(0x1100'01FD, {0x19, 0x70, 0, 0, 0, 0, 0x80, 0x3F}, at, true);
    });
    const Frames names = every(53 * ms, good, [](std::int64_t at) { // type 0: of motor 1
        return frame_at(0x0000'01FE, {1, 2, 3, 4, 5, 6, 7, 8}, at, true);
    });
    CHECK_FALSE(rules_without_description(with_all(with_all(good, values), names)).contains("silent_motor"));
}

TEST_CASE("the PDOs of CANopen drives are not commands to Damiao motors") {
    const Frames good = log_of("damiao");
    const Frames pdos = every(5 * ms, good, [](std::int64_t at) { return frame_at(0x201, {0x0F, 0}, at); });
    CHECK(rules(bus_of("damiao"), with_all(good, pdos)) == Names{});
    const Frames with_target = every(5 * ms, good, [](std::int64_t at) {
        return frame_at(0x201, {0x0F, 0, 0x10, 0x27, 0, 0, 0, 0}, at);
    });
    CHECK(rules(bus_of("damiao"), with_all(good, with_target)) == Names{});
}

TEST_CASE("a motor that shares the identifier of its answers is named if it is silent") {
    const BusDescription bus = bus_of("robstride_mit");
    const Frames good = log_of("robstride_mit");
    const auto gone_from = [&](std::int64_t stamp_ns) {
        return without(good,
                       [=](const Frame& frame) { return frame.data[0] == 2 && frame.stamp_ns >= stamp_ns; });
    };
    const BusFinding never = only_finding(bus, gone_from(0));
    CHECK(never.rule == "silent_source");
    CHECK_THAT(never.what, ContainsSubstring("0x0FD (joint 2) is never sent"));
    const BusFinding stopped = only_finding(bus, gone_from(good[2 * good.size() / 3].stamp_ns));
    CHECK(stopped.rule == "source_stopped");
    CHECK_THAT(stopped.what, ContainsSubstring("(joint 2)"));
    const std::int64_t start_ns = good.front().stamp_ns;
    const Frames slow = without(good, [=](const Frame& frame) { // 8 Hz; the others 200 Hz
        return frame.data[0] == 2 && (frame.stamp_ns - start_ns) / (5 * ms) % 25 != 0;
    });
    CHECK_FALSE(rules(bus, slow).contains("source_stopped"));
}

TEST_CASE("a heartbeat is not missing before its timeout has passed") {
    const BusDescription bus = drives_with_heartbeat("2.5");
    const Frames good = sound(bus);
    const std::int64_t start_ns = good.front().stamp_ns;
    const auto late_by = [&](std::int64_t delay_ns) {
        return without(good, [=](const Frame& frame) {
            return frame.id > 0x700 && frame.stamp_ns < start_ns + delay_ns;
        });
    };
    CHECK(rules(bus, late_by(700 * ms)) == Names{});
    CHECK(rules(bus, late_by(10'000 * ms)) == Names{"heartbeat_missing"});
}

TEST_CASE("moteus replies on extended identifiers are not rejected") {
    const Frames wide = changed(log_of("moteus"), [](Frame& frame) { frame.extended = true; });
    CHECK(rules(bus_of("moteus"), wide) == rules(bus_of("moteus"), log_of("moteus")));
}

} // namespace motor_bus_test
