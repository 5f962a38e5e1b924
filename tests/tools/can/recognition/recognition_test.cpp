// SPDX-License-Identifier: Apache-2.0
// Recognition of devices on buses without a description that are irregular, mixed or incomplete.
#include "tests/tools/can/recognition/device_logs.hpp"
#include "tests/tools/can/recognition/made_motors.hpp"
#include "tools/can/arm/bus_sampler.hpp"

#include <functional>
#include <sstream>

namespace recognition_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
namespace hal = dfdyn::hal;
using Catch::Matchers::ContainsSubstring;

std::vector<std::string> families_of(const RecognisedBus& bus) {
    std::vector<std::string> names;
    for (const RecognisedFamily& known : bus.families) {
        names.emplace_back(known.family->name);
    }
    return names;
}

using Families = std::vector<std::string>;

Families families_of(const made::Log& log) { return families_of(recognise_bus(log.frames())); }

std::string printed(const RecognisedBus& bus) {
    std::ostringstream out;
    print_recognised_bus(out, bus);
    return out.str();
}

struct Samples {
    int all = 0, collisions = 0, valid = 0;
};

Samples sampled(const nlohmann::json& draft, const Frames& frames) {
    Samples samples;
    BusSampler sampler(parse_bus_description(draft, "the draft"), [&](const BusSample& sample) {
        ++samples.all;
        samples.valid += sample.valid() ? 1 : 0;
        for (const hal::Reason reason : {sample.report.position, sample.report.output}) {
            samples.collisions += reason == hal::Reason::id_collision ? 1 : 0;
        }
    });
    for (const Frame& frame : frames) {
        sampler.take(frame, hal::BusState::active, {});
    }
    sampler.finish();
    return samples;
}

TEST_CASE("a pause and an idle start do not change the rates of a draft") {
    made::Log paused;
    made::add_damiao(paused, 3, 250, 0, 1);
    made::add_damiao(paused, 3, 250, 1.8, 4);
    made::Log idle;
    made::add_damiao(idle, 3, 50, 0, 2);
    made::add_damiao(idle, 3, 250, 2, 4);
    for (const made::Log& log : {paused, idle}) {
        const Frames frames = log.frames();
        const RecognisedBus bus = recognise_bus(frames);
        CAPTURE(bus.draft_error);
        REQUIRE(bus.draft);
        CHECK(bus.draft->at("sample_rate_hz").get<double>() == Approx(250).epsilon(0.005));
        CHECK_FALSE(bus.draft->at("joints").contains("rate_hz"));
        CHECK(sampled(*bus.draft, frames).collisions == 0);
    }
}

TEST_CASE("an adapter that delivers frames in bursts does not change the rates of a draft") {
    constexpr std::int64_t latency_ns = 16'000'000;
    for (const double rate_hz : {100.0, 500.0}) {
        made::Log log;
        made::add_damiao(log, 3, rate_hz, 0, 4);
        std::int64_t burst = 0;
        std::int64_t in_burst = 0;
        const RecognisedBus bus = recognise_bus(changed(log.frames(), [&](Frame& frame) {
            in_burst = frame.stamp_ns / latency_ns == burst ? in_burst + 1 : 0;
            burst = frame.stamp_ns / latency_ns;
            frame.stamp_ns = (burst + 1) * latency_ns + 50'000 * in_burst;
        }));
        CAPTURE(rate_hz, bus.draft_error);
        REQUIRE(bus.draft);
        CHECK(bus.draft->at("sample_rate_hz").get<double>() == Approx(rate_hz).epsilon(0.01));
        CHECK_FALSE(bus.draft->at("joints").contains("rate_hz"));
    }
}

TEST_CASE("there is no draft if the time stamps do not increase") {
    made::Log log;
    made::add_damiao(log, 3, 250, 0, 2);
    const RecognisedBus bus = recognise_bus(changed(log.frames(), [](Frame& frame) { frame.stamp_ns = 1; }));
    CHECK(families_of(bus) == Families{"damiao"});
    CHECK_FALSE(bus.draft);
    CHECK_THAT(bus.draft_error, ContainsSubstring("do not increase"));
}

TEST_CASE("a draft of motors with different rates has both, and no motor is taken for two") {
    made::Log log;
    made::add_damiao(log, 3, 250, 0, 4, [](int k) { return k == 3 ? 2 : 1; });
    const Frames frames = log.frames();
    const RecognisedBus bus = recognise_bus(frames);
    CAPTURE(bus.draft_error);
    REQUIRE(bus.draft);
    CHECK(bus.draft->at("joints").at("rate_hz").get<double>() == Approx(250).epsilon(0.005));
    CHECK(bus.draft->at("sample_rate_hz").get<double>() == Approx(125).epsilon(0.005));
    CHECK_THAT(printed(bus), ContainsSubstring("125 to 250 positions/s"));
    const Samples samples = sampled(*bus.draft, frames);
    CHECK(samples.collisions == 0);
    CHECK(2 * samples.valid > samples.all);
}

TEST_CASE("a draft of CAN FD motors is one of a CAN FD bus") {
    made::Log log;
    made::add_damiao(log, 3, 250, 0, 2);
    const RecognisedBus bus =
        recognise_bus(changed(log.frames(), [](Frame& frame) { frame.fd = frame.bit_rate_switch = true; }));
    CAPTURE(bus.draft_error);
    REQUIRE(bus.draft);
    CHECK(bus.draft->at("data_bit_rate") == 5'000'000);
    CHECK(bus.draft->at("joints").at("fd") == true);
    CHECK_THAT(printed(bus), ContainsSubstring("unsure: fd") && ContainsSubstring("unsure: data_bit_rate"));
}

TEST_CASE("CANopen drives whose TPDO looks like a feedback in MIT mode are not motors") {
    CHECK(families_of(made::canopen(6, false, false)) == Families{});
    CHECK(families_of(made::canopen(1, false, false)) == Families{});
    CHECK(families_of(made::canopen(6, true, false)) == Families{"cia402"});
    CHECK(families_of(made::canopen(1, true, false)) == Families{"cia402"});
    CHECK(families_of(made::canopen(1, true, true)) == Families{"cia402"});
    CHECK(families_of(made::canopen(1, true, false, 0)) == Families{"cia402"}); // at rest
}

TEST_CASE("commands to recognised motors are not frames of other devices") {
    const RecognisedBus rmd = recognise_bus(made::rmd_with_silent_motor().frames());
    CHECK(families_of(rmd) == Families{"rmd"});
    CHECK(rules_of(rmd).contains("silent_motor"));
    made::Log damiao;
    made::add_damiao(damiao, 14, 100, 0, 2);
    CHECK(families_of(damiao) == Families{"damiao"});
}

TEST_CASE("identifier requests to Robstride motors are not frames of servo motors") {
    made::Log log;
    for (int i = 0; i < 400; ++i) {
        double t = i / 200.0;
        for (int k = 1; k <= 3; ++k) {
            const auto motor = static_cast<std::uint32_t>(k);
            const double torque = made::effort(k, t);
            const std::array<unsigned, 4> numbers{made::code(made::angle(k, t), 4 * std::numbers::pi, 16),
                                                  made::code(made::speed(k, t), 44, 16),
                                                  made::code(torque, 17, 16), 285};
            made::Bytes feedback;
            for (const unsigned number : numbers) {
                feedback.push_back(made::byte(number >> 8U));
                feedback.push_back(made::byte(number));
            }
            log.add(t, 2U << 24U | 2U << 22U | motor << 8U | 0xFDU, feedback, true);
            if (i % 25 == 10) {
                log.add(t + 100e-6, 0xFD00U | motor, made::Bytes(8), true);
            }
            t += made::spacing_s;
        }
    }
    CHECK(families_of(log) == Families{"robstride"});
}

TEST_CASE("CubeMars motors that are cold or answer on their own identifiers are not of another family") {
    CHECK(families_of(made::cubemars(0x11, 3, true, 33)) == Families{"cubemars"});
    CHECK(families_of(made::cubemars(1, 3, false, 3)) == Families{"cubemars"});
    CHECK(families_of(made::cubemars(0x11, 3, true, 3)) == Families{"cubemars"});
    const Frames answers = without(made::cubemars(0x11, 3, true, 33).frames(),
                                   [](const Frame& frame) { return frame.data[0] == made::neutral[0]; });
    const std::string text = printed(recognise_bus(answers)); // nothing distinguishes them from Damiao motors
    CHECK_THAT(text, ContainsSubstring("cubemars") && ContainsSubstring("damiao"));
}

TEST_CASE("axes of one family are not silent motors of another") {
    made::Log log = made::cubemars(1, 3, false, 33);
    made::add_odrive(log, 1, 4, 100);
    made::add_odrive(log, 2, 5, 100);
    const RecognisedBus bus = recognise_bus(log.frames());
    CHECK(families_of(bus) == Families{"cubemars", "odrive"});
    CHECK_FALSE(rules_of(bus).contains("silent_motor"));
    CHECK_THAT(printed(bus), ContainsSubstring("the draft has the joints of cubemars only"));
}

TEST_CASE("commands to two silent motors are not an axis with angles beyond all measure") {
    made::Log log;
    made::add_damiao(log, 10, 100, 0, 2);
    const RecognisedBus bus = recognise_bus(without(log.frames(), [](const Frame& frame) {
        return frame.id == 0x11 || frame.id == 0x19; // 1 and 9, as an ODrive's heartbeat and encoder
    }));
    CHECK(families_of(bus) == Families{"damiao"});
    CHECK(std::ranges::count(bus.findings, "silent_motor", &BusFinding::rule) == 2);
}

TEST_CASE("of two motors with one number the one on the usual identifier is in the draft") {
    made::Log log;
    for (int i = 0; i < 400; ++i) {
        const double t = i / 200.0;
        log.add(t, 0x11, made::mit_feedback(0x11, 1, t, {12.5, 30, 10}, {31, 34}));
        log.add(t + made::spacing_s, 0x21, made::mit_feedback(0x11, 2, t, {12.5, 30, 10}, {31, 34}));
    }
    const RecognisedBus bus = recognise_bus(log.frames());
    CHECK(families_of(bus) == Families{"damiao"});
    CAPTURE(bus.draft_error);
    REQUIRE(bus.draft);
    REQUIRE(bus.draft->at("joints").at("boards").size() == 1);
    CHECK(bus.draft->at("joints").at("boards").at(0).at("feedback_id") == "0x11");
    CHECK_THAT(printed(bus), ContainsSubstring("frames on 0x21 have its number, too"));
}

TEST_CASE("the draft is that of the first family with efforts, and its absence is explained") {
    made::Log axes;
    for (int k = 1; k <= 4; ++k) {
        made::add_odrive(axes, static_cast<unsigned>(k), k + 2, 500);
    }
    const RecognisedBus none = recognise_bus(axes.frames());
    CHECK_FALSE(none.draft);
    CHECK(none.draft_error == "odrive: its frames contain no efforts");
    made::add_damiao(axes, 2, 250, 0, 2);
    const RecognisedBus bus = recognise_bus(axes.frames());
    CHECK(families_of(bus) == Families{"odrive", "damiao"});
    CAPTURE(bus.draft_error);
    REQUIRE(bus.draft);
    CHECK(bus.draft->at("joints").at("family") == "damiao");
    CHECK(bus.draft->at("joints").at("boards").size() == 2);
}

TEST_CASE("a draft has the first twelve motors and names the others") {
    made::Log log;
    made::add_damiao(log, 14, 100, 0, 2);
    const RecognisedBus bus = recognise_bus(log.frames());
    CAPTURE(bus.draft_error);
    REQUIRE(bus.draft);
    CHECK(bus.draft->at("joints").at("boards").size() == 12);
    CHECK_THAT(printed(bus), ContainsSubstring("motor 13") && ContainsSubstring("at most 12 joints: "));
}

RecognisedBus recorded(const Frames& frames) {
    TrafficRecorder recorder;
    for (const Frame& frame : frames) {
        recorder.take(frame);
    }
    return recognise_bus(recorder.frames());
}

TEST_CASE("pauses and clock steps do not use up the time for the recognition") {
    made::Log late;
    late.add(0, 0x7FF, {1, 0, 0x33, 21, 0, 0, 0, 0});
    made::add_damiao(late, 2, 100, 6, 14);
    const RecognisedBus bus = recorded(late.frames());
    CHECK(families_of(bus) == Families{"damiao"});
    CHECK(bus.duration_s == Approx(TrafficRecorder::longest_s).epsilon(0.01));
    made::Log arm;
    made::add_damiao(arm, 2, 100, 0, 4);
    Frames set_back = arm.frames();
    for (std::size_t i = 3; i < set_back.size(); ++i) {
        set_back[i].stamp_ns -= 3'600'000'000'000;
    }
    CHECK(families_of(recorded(set_back)) == Families{"damiao"});
    made::Log other;
    other.add(0, 0x7FF, {1, 0, 0x33, 21, 0, 0, 0, 0});
    CHECK_THAT(recorded(other.frames()).draft_error, ContainsSubstring("recognised in one frame"));
}

TEST_CASE("frames of two receive queues in turn do not add to the time of the traffic") {
    TrafficTime time;
    const auto take = [&](std::int64_t from_ns) {
        for (std::int64_t i = 0; i <= 1000; ++i) {
            time.take(from_ns + 1'000'000 * i);
            time.take(from_ns + 1'000'000 * (i - 10));
        }
    };
    take(0);
    CHECK(time.seconds() == Approx(1));
    take(-3'600'000'000'000); // the clock is set back
    CHECK(time.seconds() == Approx(2));
}

TEST_CASE("a finding about the whole bus is printed once") {
    made::Log log;
    made::add_damiao(log, 3, 250, 0, 4);
    Frames frames = log.frames();
    for (std::size_t i = frames.size() / 2; i < frames.size(); ++i) {
        frames[i].stamp_ns += 3'600'000'000'000;
    }
    const BusCheck check = checked(std::nullopt, frames);
    std::vector<BusFinding> findings = bus_findings(check);
    add_findings(recognise_bus(frames), check, findings);
    CHECK(std::ranges::count(findings, "clock_jumped", &BusFinding::rule) == 1);
}

} // namespace recognition_test
