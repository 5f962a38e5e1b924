// SPDX-License-Identifier: Apache-2.0
// Each rule reports a log with its fault, and no rule reports a log without faults.
#include "tools/can/check/bus_check.hpp"

#include "dfdyn/hal/replay_bus.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_check_support.hpp"

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

/// A recording whose interface was down for some of its frames, which a log does not show.
class BrokenBus {
  public:
    BrokenBus(TapeBus& bus, std::uint64_t down_from, std::uint64_t down_to)
        : bus_(bus), down_from_(down_from), down_to_(down_to) {}

    std::span<const Frame> drain(std::span<Frame> into) noexcept {
        const std::span<const Frame> frames = bus_.drain(into);
        const std::uint64_t count = bus_.counters().received;
        const bool was_down = down_;
        down_ = count > down_from_ && count <= down_to_;
        const std::uint64_t downs = counters_.interface_down + (down_ && !was_down ? 1 : 0);
        counters_ = bus_.counters();
        counters_.interface_down = downs;
        return down_ ? frames.first(0) : frames;
    }
    dfdyn::hal::SendResult send(const Frame& frame) noexcept { return bus_.send(frame); }
    std::int64_t now_ns() const noexcept { return bus_.now_ns(); }
    dfdyn::hal::BusState state() const noexcept {
        return down_ ? dfdyn::hal::BusState::interface_down : bus_.state();
    }
    const dfdyn::hal::BusCounters& counters() const noexcept { return counters_; }

  private:
    TapeBus& bus_;
    std::uint64_t down_from_, down_to_;
    bool down_ = false;
    dfdyn::hal::BusCounters counters_;
};

const std::string loaded = R"({
  "schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 1000, "trigger": {"on": "timer"},
  "joints": {"family": "icub_two_joint_board", "boards": [
    {"address": 1, "joints": [1, 2], "ticks_per_degree": [182, 182]},
    {"address": 2, "joints": [3, 4], "ticks_per_degree": [182, 182]},
    {"address": 3, "joints": [5, 6], "ticks_per_degree": [182, 182]},
    {"address": 4, "joints": [7, 8], "ticks_per_degree": [182, 182]}]},
  "output": {"family": "icub_strain", "address": 13, "full_scale": [1500, 1500, 2000, 35, 35, 25]}
})";
bool is_first(const Frame& frame) { return !frame.error && frame.id == 0x111; }
bool is_wrench(const Frame& frame) { return frame.id == 0x3DA || frame.id == 0x3DB; }

} // namespace

TEST_CASE("a bus of any family without faults gives no finding") {
    for (const char* const name : {"icub_arm_strain", "ur5_cia402", "ur5_cia402_torque", "ur5_icub_2foc",
                                   "ur5_two_joint_boards", "ur5_dbc"}) {
        CAPTURE(name);
        const BusDescription description = read_bus_description(bus_folder + name + ".json");
        CHECK(rules(description, sound(description)) == Names{});
    }
    CHECK(rules(described(odrive_and_ati), sound(described(odrive_and_ati))) == Names{});
    CHECK(rules(described(foc_and_robotous), sound(described(foc_and_robotous))) == Names{});
    CHECK(rules(described(loaded), sound(described(loaded), 4, 50)) == Names{}); // 77 %
}

TEST_CASE("lost arbitration and an unknown sender with a low rate give no finding") {
    const BusDescription bus = icub();
    CHECK(rules(bus, with(sound(bus), error_frame(dfdyn::hal::error_class::lost_arbitration))) == Names{});
    CHECK(rules(bus, with(sound(bus), dfdyn::hal::make_frame(0x7A5, 8))) == Names{});
}

TEST_CASE("a fault of a source is found by its rule and no other") {
    const BusDescription bus = icub();
    const Frames good = sound(bus);
    SECTION("never there") { CHECK(rules(bus, without(good, is_first)) == Names{"silent_source"}); }
    SECTION("on another identifier") {
        const Frames moved =
            changed(good, [](Frame& frame) { frame.id = is_first(frame) ? 0x151 : frame.id; });
        CHECK(rules(bus, moved).contains("wrong_identifier"));
        CHECK_FALSE(rules(bus, moved).contains("silent_source"));
    }
    SECTION("gone after 3 s") {
        CHECK(rules(bus, without(good, [](const Frame& frame) {
                        return is_first(frame) && frame.stamp_ns > 3'000'000'000;
                    })) == Names{"source_stopped"});
    }
    SECTION("a quarter lost") {
        int count = 0;
        CHECK(rules(bus, without(good, [&](const Frame& frame) {
                        return is_first(frame) && ++count % 4 == 0;
                    })) == Names{"lost_frames"});
    }
    SECTION("slower than described") {
        BusDescription faster = bus;
        faster.joints.rate_hz = 1200;
        CHECK(rules(faster, good).contains("slow_source"));
        CHECK_FALSE(rules(faster, good).contains("lost_frames"));
    }
    SECTION("gone for 20 ms") {
        CHECK(rules(bus, without(good, [](const Frame& frame) {
                        return is_first(frame) && frame.stamp_ns / 20'000'000 == 100;
                    })) == Names{"gaps"});
    }
    SECTION("another length now and then") {
        int count = 0;
        CHECK(rules(bus, changed(good, [&](Frame& frame) {
                        frame.length = is_first(frame) && ++count % 500 == 0 ? 6 : frame.length;
                    })) == Names{"rejected_frames"});
    }
    SECTION("early and late") {
        const BusDescription slow = described(foc_and_robotous);
        int count = 0;
        CHECK(rules(slow, changed(sound(slow), [&](Frame& frame) {
                        frame.stamp_ns += frame.id == 0x110 && ++count % 2 == 0 ? 1'500'000 : 0;
                    })) == Names{"jitter"});
    }
}

TEST_CASE("two devices on one identifier are distinguished from one that is faster than described") {
    const BusDescription bus = icub();
    Frames twice = sound(bus);
    for (const Frame& frame : sound(bus)) {
        if (is_wrench(frame)) {
            twice.push_back(frame);
            twice.back().stamp_ns += 450'000;
            twice.back().data[0] ^= 0x55;
        }
    }
    CHECK(rules(bus, changed(twice, [](Frame&) {})) == Names{"id_collision"});
    BusDescription slower = bus;
    slower.output.rate_hz = 900;
    CHECK(rules(slower, sound(bus)) == Names{"fast_source"});
}

TEST_CASE("a fault of the bus is found by its rule and no other") {
    const BusDescription bus = icub();
    const Frames good = sound(bus);
    namespace error_class = dfdyn::hal::error_class;
    const auto rules_with = [&](const Frame& frame) { return rules(bus, with(good, frame)); };
    CHECK(rules_with(error_frame(error_class::controller, 0x10)) == Names{"error_passive"});
    CHECK(rules_with(error_frame(error_class::controller, 0x04)) == Names{"error_passive"});
    CHECK(rules_with(error_frame(error_class::protocol)) == Names{"wire_errors"});
    CHECK(rules_with(error_frame(error_class::no_acknowledgement)) == Names{"no_acknowledgement"});
    CHECK(rules_with(error_frame(error_class::controller, 0x01)) == Names{"frames_dropped"});
    CHECK(rules_with(error_frame(error_class::bus_off)).contains("bus_off"));
    CHECK(rules(bus, good, 7) == Names{"frames_dropped"});
    CHECK(rules(bus, {}) == Names{"silent_bus"});
    Frame overflow = dfdyn::hal::make_frame(0x115, 0); // the board's report of lost packets
    CHECK(rules_with(overflow) == Names{"device_lost_frames"});
    const Frames jumped = changed(good, [](Frame& frame) { frame.stamp_ns += 10'000'000'000; });
    Frames set_back = jumped;
    set_back.insert(set_back.end(), good.begin(), good.end());
    CHECK(rules(bus, set_back).contains("clock_jumped"));
}

TEST_CASE("an interface that went down is reported in addition to the missing frames") {
    const BusDescription bus = icub();
    const Frames good = sound(bus); // 4 s
    const std::uint64_t count = good.size();
    const auto rules_down = [&](std::uint64_t from, std::uint64_t to) {
        BusCheck check(bus);
        Tape tape(good);
        TapeBus recording(tape);
        BrokenBus broken(recording, from, to);
        watch(check, recording, broken);
        return rules_of(check);
    };
    CHECK(rules_down(count, count) == Names{});
    CHECK(rules_down(count / 2, count / 2 + 4) == Names{"interface_down"});
    CHECK(rules_down(count / 2, count / 2 + 400) == Names{"interface_down", "gaps"}); // 0.1 s
    CHECK(rules_down(count / 2, count) == Names{"interface_down", "source_stopped"});
}

TEST_CASE("time stamps that repeat or run backward are reported unless they are rare") {
    const BusDescription bus = icub();
    const Frames good = sound(bus);
    const auto stamped = [&](int every, std::int64_t step_ns) {
        Frames frames = good;
        int count = 0;
        std::int64_t before_ns = 0;
        for (Frame& frame : frames) {
            if (is_first(frame)) {
                frame.stamp_ns = ++count % every == 0 ? before_ns + step_ns : frame.stamp_ns;
                before_ns = frame.stamp_ns;
            }
        }
        return rules(bus, frames);
    };
    CHECK(stamped(10, 0).contains("time_not_increasing"));
    CHECK(stamped(10, -200'000).contains("time_not_increasing"));
    CHECK_FALSE(stamped(10, 1).contains("time_not_increasing"));
    CHECK_FALSE(stamped(100, 0).contains("time_not_increasing")); // in a quarter of the frames
}

TEST_CASE("the load is the bits of all frames relative to the bit rate") {
    BusDescription bus = icub();
    const Frames good = sound(bus);
    // per millisecond 2 x 135 bits of the joints and 2 x 115 of the sensor
    const BusCheck check = checked(bus, good);
    CHECK(check.load().mean(check.duration_s()) == Approx(0.5).epsilon(0.01));
    CHECK(check.load().expected() == Approx(0.5));
    bus.bit_rate = 640'000;
    CHECK(rules(bus, good) == Names{});
    bus.bit_rate = 600'000;
    CHECK(rules(bus, good) == Names{"overload"});
    bus.bit_rate = 1'000'000;
    Frames crowded = good;
    for (std::int64_t number = 0; number < 4'000; ++number) {
        crowded.push_back(dfdyn::hal::make_frame(0x600 + static_cast<std::uint32_t>(number % 5), 8));
        crowded.back().stamp_ns = 10'000'000 + number * 1'000'000;
    }
    CHECK(rules(bus, changed(crowded, [](Frame&) {})) == Names{"unknown_traffic"});
}

TEST_CASE("a condition that a board or sensor reports is found by its rule") {
    const BusDescription bus = icub();
    const Frames good = sound(bus);
    const auto changed_wrench = [&](auto change) {
        return rules(bus, changed(good, [&](Frame& frame) {
                         if (is_wrench(frame)) {
                             change(frame);
                         }
                     }));
    };
    CHECK(changed_wrench([](Frame& frame) { frame.data = {0x10, 0x81, 0x20, 0x82, 0x30, 0x83}; }) ==
          Names{"sensor_frozen"});
    CHECK(changed_wrench([](Frame& frame) { frame.length = 7; }) == Names{"sensor_saturated"});
    const auto is_torque = [](const Frame& frame) { return frame.id == 0x3DB; };
    CHECK(rules(bus, without(good, is_torque)) == Names{"silent_source", "incomplete_wrench"});
    Frame status = dfdyn::hal::make_frame(0x113, 8);
    status.data[0] = 0x20; // absolute encoder error of joint 1
    CHECK(rules(bus, with(good, status)) == Names{"encoder_fault"});
    BusDescription narrow = bus;
    narrow.position_limit_rad = 0.5;
    CHECK(rules(narrow, good) == Names{"position_out_of_range"});
    narrow = bus;
    narrow.output_range[3] = {-1, 1};
    CHECK(rules(narrow, good) == Names{"output_out_of_range"});
    const auto is_reply = [](const Frame& frame) { return frame.id == 0x2D0; };
    const std::string text = dfdyn::tests::file_content(bus_folder + "icub_arm_strain.json");
    const BusDescription untold = described(text.substr(0, text.find(", \"full_scale\"")) + "}}");
    CHECK(rules(untold, good) == Names{});
    CHECK(rules(untold, without(good, is_reply)) == Names{"full_scale_unknown"});
    CHECK(rules(untold, changed(good, [&](Frame& frame) {
                    frame.data[2] = is_reply(frame) ? 0 : frame.data[2];
                    frame.data[3] = is_reply(frame) ? 0 : frame.data[3];
                })) == Names{"full_scale"});
}

TEST_CASE("a condition that a drive reports is found by its rule") {
    std::string text = dfdyn::tests::file_content(bus_folder + "ur5_cia402.json");
    const std::string family = "\"family\": \"cia402\",";
    text.insert(text.find(family) + family.size(), "\"heartbeat_timeout_s\": 0.25,");
    const BusDescription drives = described(text);
    const Frames good = sound(drives);
    CHECK(rules(drives, good) == Names{});
    const auto is_heartbeat = [](const Frame& frame) { return frame.id > 0x700; };
    CHECK(rules(drives, without(good, is_heartbeat)) == Names{"heartbeat_missing"});
    CHECK(rules(drives, changed(good, [&](Frame& frame) {
                    frame.data[0] = is_heartbeat(frame) ? 0x7F : frame.data[0];
                })) == Names{"not_operational"});
    Frame emcy = dfdyn::hal::make_frame(0x83, 8);
    emcy.data[1] = 0x23; // 0x2300: over-current
    CHECK(rules(drives, with(good, emcy)) == Names{"device_fault"});
    // an encoder that remains at zero
    CHECK(rules(drives, changed(good, [](Frame& frame) {
                    frame.data = frame.id == 0x281 ? std::array<std::uint8_t, 64>{} : frame.data;
                })) == Names{"zeros"});
}

TEST_CASE("frames of more identifiers than are stored are observed in bounded memory") {
    const BusDescription bus = icub();
    Frames flood = sound(bus, 1);
    for (std::uint32_t id = 0; id < 20'000; ++id) {
        flood.push_back(dfdyn::hal::make_frame(id, 0));
        flood.back().extended = true;
        flood.back().stamp_ns = 900'000'000 + id;
    }
    const BusCheck check = checked(bus, changed(flood, [](Frame&) {}));
    CHECK(check.streams().size() == BusCheck::most_streams);
    std::ostringstream out;
    print_bus_check(out, check, bus_findings(check));
    CHECK_THAT(out.str(),
               Catch::Matchers::Contains("0x111 ") && Catch::Matchers::Contains("joint 1, joint 2\n"));
}

TEST_CASE("each identifier begins a line of the report, also if twelve joints share one") {
    std::string boards;
    for (int joint = 1; joint <= 12; ++joint) {
        const std::string number = std::to_string(joint);
        boards += std::string(joint > 1 ? ", " : "") + R"({"motor": "AK80-9", "motor_id": )" + number +
                  R"(, "joint": )" + number + "}";
    }
    const BusDescription bus = described(
        R"({"schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 100, "trigger": {"on": "set"},
            "joints": {"family": "cubemars", "boards": [)" +
        boards + R"(]}, "output": {"family": "efforts", "quantity": "tau"}})");
    Frames frames(2, dfdyn::hal::make_frame(0x7A5, 8));
    frames[1].stamp_ns = 1'000'000'000;
    std::ostringstream out;
    print_bus_check(out, checked(bus, frames), {});
    CHECK_THAT(out.str(), Catch::Matchers::Contains("joint 11, joint 12\n0x7A5 "));
}
