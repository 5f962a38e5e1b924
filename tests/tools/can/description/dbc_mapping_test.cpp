// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/replay_bus.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tools/base/text/error.hpp"
#include "tools/can/arm/bus_sampler.hpp"
#include "tools/can/arm/device_frames.hpp"
#include "tools/can/description/dbc.hpp"
#include "tools/can/log/candump_log.hpp"

#include <array>
#include <numbers>

namespace {

using namespace dfdyn::tools;
using Catch::Matchers::EndsWith;
using dfdyn::hal::Decoded;
using dfdyn::hal::Frame;
using dfdyn::hal::Reason;
using dfdyn::tests::bus_folder;
using dfdyn::tests::file_content;
using dfdyn::tests::IcubLog;
using dfdyn::tests::TemporaryDirectory;

BusDescription ur5() { return read_bus_description(bus_folder + "ur5_dbc.json"); }

/// Decodes a frame for all joints; joints that are not in the frame keep their values.
struct Joints {
    std::vector<AnyBoard> boards;
    std::vector<dfdyn::hal::JointValue> value;
    int rejected = 0;
    Reason last_rejection = Reason::ok;

    explicit Joints(const BusDescription& description) : value(description.boards.size()) {
        for (const BusBoard& board : description.boards) {
            boards.push_back(board.board);
        }
    }

    void take(const Frame& frame) {
        for (AnyBoard& board : boards) {
            const Decoded decoded = board.decode(frame);
            rejected += decoded.kind == Decoded::Kind::rejected ? 1 : 0;
            last_rejection = decoded.kind == Decoded::Kind::rejected ? decoded.reason : last_rejection;
            for (int i = 0; i < decoded.joints; ++i) {
                take(decoded.joint.at(static_cast<std::size_t>(i)));
            }
        }
    }

  private:
    void take(const dfdyn::hal::JointValue& news) {
        dfdyn::hal::JointValue& old = value.at(static_cast<std::size_t>(news.joint));
        if (news.position_reason != Reason::waiting_for_position) {
            old.position_reason = news.position_reason;
            old.position_rad = news.position_rad;
        }
        if (news.effort_reason != Reason::no_output) {
            old.effort_reason = news.effort_reason;
            old.effort = news.effort;
        }
    }
};

/// A sensor whose values are in the variants of one message of six bytes; `mx` replaces the signal of its Mx.
BusDescription multiplexed_sensor(const std::string& mx = R"({"message": "Ft", "signal": "Mx"})") {
    const TemporaryDirectory directory;
    directory.write("ft.dbc", R"(BO_ 500 Ft: 8 A
 SG_ Mode M : 7|8@0+ (1,0) [0|0] "" B
 SG_ Fx m0 : 15|16@0- (0.05,0) [-1000|1000] "N" B
 SG_ Fy m0 : 31|16@0- (0.05,0) [-1000|1000] "N" B
 SG_ Fz m0 : 47|16@0- (0.05,0) [-1000|1000] "N" B
 SG_ Mx m8 : 15|16@0- (0.001,0) [0|0] "Nm" B
 SG_ My m8 : 31|16@0- (0.001,0) [0|0] "Nm" B
 SG_ Mz m8 : 47|16@0- (0.001,0) [0|0] "Nm" B
BO_ 501 Other: 8 A
 SG_ Odd : 0|16@1- (1,0) [0|0] "" B
)");
    directory.write("arm.dbc", file_content(bus_folder + "ur5_dbc.dbc"));
    const std::string joints = file_content(bus_folder + "ur5_dbc.json");
    std::string text = joints.substr(0, joints.find("\"ur5_dbc.dbc\"")) + "\"arm.dbc\"" +
                       joints.substr(joints.find("\"ur5_dbc.dbc\"") + 13);
    text = text.substr(0, text.rfind("\"output\"")) +
           R"("output": {"family": "dbc", "file": "ft.dbc", "limit": [900, 900, 900, 30, 30, 30], "wrench": [
        {"message": "Ft", "signal": "Fx"}, {"message": "Ft", "signal": "Fy"}, {"message": "Ft", "signal": "Fz"},
        )" +
           mx + R"(, {"message": "Ft", "signal": "My"}, {"message": "Ft", "signal": "Mz"}]}})";
    return read_bus_description(directory.write("bus.json", text));
}

std::string refusal_of(const std::string& from, const std::string& to) {
    const TemporaryDirectory directory;
    directory.write("ur5_dbc.dbc", file_content(bus_folder + "ur5_dbc.dbc"));
    std::string text = file_content(bus_folder + "ur5_dbc.json");
    const std::size_t place = text.find(from);
    REQUIRE(place != std::string::npos);
    try {
        read_bus_description(directory.write("bus.json", text.replace(place, from.size(), to)));
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

} // namespace

TEST_CASE("joints with signals of every kind share frames and are decoded to within half a step") {
    DFDYN_SEEDED_ENGINE(engine);
    const BusDescription description = ur5();
    const DeviceFrames device(description);
    Joints joints(description);
    const std::array<double, 6> step{1.745e-6, 1.745e-6, 1e-6, 1e-6, 4e-6, 1e-15};
    const std::array<double, 6> effort_step{0.01, 0.001, 0.001, 0.001, 1e-5, 0.0005};
    std::uniform_real_distribution<double> angle(-3, 3);
    std::uniform_real_distribution<double> current(-1.9, 1.9);
    for (int round = 0; round < 1000; ++round) {
        std::vector<double> position(6);
        std::vector<double> effort(6);
        std::ranges::generate(position, [&] { return angle(engine); });
        std::ranges::generate(effort, [&] { return current(engine); });
        const std::vector<Frame> frames = device.joints(position, effort);
        REQUIRE(frames.size() == 7); // of 6 messages, one of them twice
        std::ranges::for_each(frames, [&](const Frame& frame) { joints.take(frame); });
        for (std::size_t i = 0; i < 6; ++i) {
            CAPTURE(i);
            REQUIRE(joints.value[i].position_reason == Reason::ok);
            REQUIRE(joints.value[i].effort_reason == Reason::ok);
            REQUIRE(std::abs(joints.value[i].position_rad - position[i]) <= 0.5001 * step[i]);
            REQUIRE(std::abs(joints.value[i].effort - effort[i]) <= 0.5001 * effort_step[i]);
        }
    }
    CHECK(joints.rejected == 0);
}

TEST_CASE("impossible values of a mapped signal are rejected") {
    const BusDescription description = ur5();
    const std::vector<Frame> good =
        DeviceFrames(description).joints(std::vector<double>(6, 0.5), std::vector<double>(6, 1));
    const auto after = [&](std::size_t index, auto change) {
        Joints joints(description);
        Frame frame = good.at(index);
        change(frame);
        joints.take(frame);
        return joints;
    };
    const auto frame_of = [&](std::uint32_t id) {
        return static_cast<std::size_t>(std::ranges::find(good, id, &Frame::id) - good.begin());
    };
    // 401 degrees, where the limit in the DBC file is 400; the other joint of the frame has no fault
    const Joints far = after(frame_of(0x120), [](Frame& frame) {
        dfdyn::hal::store_little<std::int32_t>(frame.data.data(), 4'010'000);
    });
    CHECK(far.value[0].position_reason == Reason::position_out_of_range);
    CHECK(far.value[1].position_reason == Reason::ok);
    const Joints nan =
        after(frame_of(0x122), [](Frame& frame) { frame.data[2] = 0xC0, frame.data[3] = 0x7F; });
    CHECK(nan.value[4].position_reason == Reason::position_out_of_range);
    const Joints other_variant = after(frame_of(0x121), [](Frame& frame) { frame.data[0] = 0x07; });
    CHECK(other_variant.value[2].position_reason == Reason::waiting_for_position);
    CHECK(other_variant.value[3].position_reason == Reason::waiting_for_position);
    CHECK(other_variant.rejected == 0);
    const Joints shorter = after(frame_of(0x123), [](Frame& frame) { frame.length = 7; });
    CHECK(shorter.last_rejection == Reason::wrong_length);
    const Joints remote = after(frame_of(0x123), [](Frame& frame) { frame.remote = true; });
    CHECK(remote.last_rejection == Reason::wrong_frame_type);
    const Joints standard = after(frame_of(0x18FEF004), [](Frame& frame) { frame.extended = false; });
    CHECK(standard.value[0].effort_reason == Reason::no_output);
}

TEST_CASE("a strain board that is decoded by its DBC file gives the samples of its own decoder") {
    const IcubLog log;
    std::string text = file_content(bus_folder + "icub_arm_strain.json");
    text = text.substr(0, text.rfind("\"output\"")) +
           R"("output": {"family": "dbc", "file": ")" DFDYN_TEST_DATA_DIR
           R"(/../../hal/dbc/icub_strain.dbc", "limit": [1500, 1500, 2000, 35, 35, 25], "wrench": [
        {"message": "Force", "signal": "fx"}, {"message": "Force", "signal": "fy"}, {"message": "Force", "signal": "fz"},
        {"message": "Torque", "signal": "mx"}, {"message": "Torque", "signal": "my"}, {"message": "Torque", "signal": "mz"}]}})";
    const auto samples_of = [&](const BusDescription& description) {
        std::vector<BusSample> samples;
        BusSampler sampler(description, [&](const BusSample& sample) { samples.push_back(sample); });
        CandumpLog frames(log.path);
        dfdyn::hal::ReplayEntry entry;
        while (frames.next(entry)) {
            sampler.take(entry.frame, dfdyn::hal::BusState::active, {});
        }
        return samples;
    };
    const std::vector<BusSample> own = samples_of(log.bus);
    const std::vector<BusSample> mapped =
        samples_of(read_bus_description(log.directory.write("dbc.json", text)));
    REQUIRE(own.size() == mapped.size());
    REQUIRE(std::ranges::count_if(own, [](const BusSample& one) { return one.sample.output_valid; }) > 480);
    for (std::size_t i = 0; i < own.size(); ++i) {
        REQUIRE(own[i].sample.time_ns == mapped[i].sample.time_ns);
        REQUIRE(own[i].report.output == mapped[i].report.output);
        for (std::size_t k = 0; k < own[i].valid_outputs().size(); ++k) {
            REQUIRE(own[i].valid_outputs()[k] == Approx(mapped[i].valid_outputs()[k]).margin(1e-9));
        }
    }
}

TEST_CASE("a sensor in two variants of one message is paired and limited and its saturation is detected") {
    const BusDescription description = multiplexed_sensor();
    AnySensor sensor = *description.sensor;
    const dfdyn::hal::Wrench wrench{100, -200, 300, 1, -2, 3};
    const std::vector<Frame> frames = DeviceFrames(description).wrench(wrench);
    REQUIRE(frames.size() == 2);
    CHECK(frames[0].id == frames[1].id);
    CHECK(sensor.decode(frames[0]).kind == Decoded::Kind::part);
    CHECK(sensor.decode(frames[0]).part == 0);
    CHECK(sensor.decode(frames[1]).part == 1);
    const dfdyn::hal::WrenchReading reading = sensor.wrench(frames[0], frames[1]);
    CHECK(reading.reason == Reason::ok);
    for (std::size_t i = 0; i < 6; ++i) {
        CHECK(reading.value[i] == Approx(wrench[i]));
    }
    Frame third = frames[0];
    third.data[0] = 5;
    CHECK(sensor.decode(third).kind == Decoded::Kind::nothing);
    const auto reason_of = [&](std::size_t half, std::uint8_t high, std::uint8_t low) {
        std::vector<Frame> changed = frames;
        changed[half].data[1] = high;
        changed[half].data[2] = low;
        return sensor.wrench(changed[0], changed[1]).reason;
    };
    CHECK(reason_of(1, 0x7F, 0xFF) == Reason::output_saturated);
    CHECK(reason_of(1, 0x80, 0x00) == Reason::output_saturated);
    CHECK(reason_of(1, 0x7F, 0xFE) == Reason::ok);
    CHECK(reason_of(0, 0x4E, 0x21) == Reason::output_out_of_range); // 1000.05 N
    CHECK(reason_of(0, 0x4E, 0x20) == Reason::ok);
    const auto raw = sensor.wrench(frames[0], frames[1]).raw;
    std::vector<Frame> moved = frames;
    moved[1].data[2] ^= 1;
    CHECK(sensor.wrench(moved[0], moved[1]).raw != raw); // the raw values differ, so the sensor is not frozen
}

TEST_CASE("a joint in nested multiplexed pages of a message is decoded in these pages only") {
    const std::string dbc = "BO_ 288 Drive: 8 A\n"
                            " SG_ Page M : 0|8@1+ (1,0) [0|0] \"\" B\n"
                            " SG_ Axis m2M : 8|8@1+ (1,0) [0|0] \"\" B\n"
                            " SG_ Q m1 : 16|32@1- (0.001,0) [0|0] \"rad\" B\n"
                            "BO_ 289 Effort: 2 A\n"
                            " SG_ I : 0|16@1- (0.001,0) [0|0] \"A\" B\n";
    const std::string pages = "SG_MUL_VAL_ 288 Axis Page 2-2;\nSG_MUL_VAL_ 288 Q Axis 1-1, 4-6;\n";
    const std::string bus =
        R"({"schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 100, "trigger": {"on": "timer"},
            "joints": {"family": "dbc", "file": "arm.dbc", "boards": [{"joint": 1,
              "position": {"message": "Drive", "signal": "Q"}, "effort": {"message": "Effort", "signal": "I"}}]},
            "output": {"family": "efforts", "quantity": "i"}})";
    const TemporaryDirectory directory;
    const auto path = directory.write("bus.json", bus);
    directory.write("arm.dbc", dbc + pages);
    const BusDescription description = read_bus_description(path);
    Frame frame = DeviceFrames(description).joints(std::vector<double>{0.5}, std::vector<double>{1}).front();
    CHECK(frame.data[0] == 2);
    CHECK(frame.data[1] == 1);
    const auto position = [&](std::uint8_t page, std::uint8_t axis) {
        Joints joints(description);
        frame.data[0] = page;
        frame.data[1] = axis;
        joints.take(frame);
        return joints.value[0];
    };
    for (const std::uint8_t axis : std::array<std::uint8_t, 3>{1, 4, 6}) {
        CHECK(position(2, axis).position_reason == Reason::ok);
        CHECK(position(2, axis).position_rad == Approx(0.5));
        CHECK(position(3, axis).position_reason == Reason::waiting_for_position);
    }
    CHECK(position(2, 2).position_reason == Reason::waiting_for_position);
    CHECK(position(2, 7).position_reason == Reason::waiting_for_position);
    directory.write("arm.dbc", dbc); // Q's multiplexor is ambiguous
    CHECK_THROWS_WITH(read_bus_description(path),
                      EndsWith("position.signal: expected a signal whose multiplexor is known: the only one "
                               "of its message, or the one that SG_MUL_VAL_ names, found \"Q\" of Drive"));
    directory.write("arm.dbc", dbc + "SG_MUL_VAL_ 288 Axis Q 2-2;\nSG_MUL_VAL_ 288 Q Axis 1-1;\n");
    CHECK_THROWS_AS(read_bus_description(path), InputError);
}

TEST_CASE("signals have the same bits as in cantools") {
    // Example of the cantools manual: 250.1 K, 3.2 m, enabled is C0 01 40; with 250.55 K it is C0 06 E0.
    const Dbc dbc = parse_dbc(R"(BO_ 496 ExampleMessage: 8 PCM1
 SG_ Temperature : 0|12@0- (0.01,250) [229.52|270.47] "degK" PCM1,FOO
 SG_ AverageRadius : 6|6@0+ (0.1,0) [0|5] "m" Vector__XXX
 SG_ Enable : 7|1@0+ (1,0) [0|0] "-" Vector__XXX
)",
                              "motohawk.dbc");
    const DbcMessage& message = *dbc.find("ExampleMessage");
    const auto encoded = [&](double temperature) {
        std::array<std::uint8_t, 8> data{};
        message.find("Temperature")->signal.insert(data, temperature);
        message.find("AverageRadius")->signal.insert(data, 3.2);
        message.find("Enable")->signal.insert(data, 1);
        return data;
    };
    CHECK(encoded(250.1) == std::array<std::uint8_t, 8>{0xC0, 0x01, 0x40});
    CHECK(encoded(250.55) == std::array<std::uint8_t, 8>{0xC0, 0x06, 0xE0});
    CHECK(message.find("Temperature")->signal.extract(encoded(250.55)) == Approx(250.55));
}

TEST_CASE("an impossible mapping is rejected with field and expected value and found value") {
    CHECK_THAT(refusal_of("\"Wrist3\", \"signal\"", "\"Wrist4\", \"signal\""),
               EndsWith(R"(position.message: expected a message of the DBC file, found "Wrist4")"));
    CHECK_THAT(refusal_of("\"signal\": \"Elbow\"", "\"signal\": \"Hand\""),
               EndsWith(R"(position.signal: expected a signal of Wrist, found "Hand")"));
    CHECK_THAT(refusal_of("\"signal\": \"Lift\"", "\"signal\": \"Pan\""),
               EndsWith(R"(position.signal: expected one that no other joint has, found "Pan")"));
    CHECK_THAT(refusal_of("\"turn\"", "\"degree\""),
               EndsWith(R"(unit: expected rad, deg or turn, found "degree")"));
    CHECK_THAT(refusal_of("\"scale\": -1", "\"scale\": 0"),
               EndsWith("scale: expected a number that is not 0, found 0"));
    CHECK_THAT(refusal_of("ur5_dbc.dbc", "none.dbc"), Catch::Matchers::Contains("none.dbc"));
    CHECK_THAT(refusal_of("\"joint\": 6", "\"joint\": 5"),
               EndsWith("found joint 6 after another one of that number") || EndsWith("missing"));
    CHECK_THROWS_WITH(
        multiplexed_sensor(R"({"message": "Other", "signal": "Odd"})"),
        EndsWith("output.wrench: expected signals in two frames: two messages, or two variants of "
                 "one, found another number of frames"));
    CHECK_THROWS_WITH(multiplexed_sensor(R"({"message": "Ft", "signal": "My"})"),
                      EndsWith(R"(signal: expected another one than for the other axes, found "My")"));
}
