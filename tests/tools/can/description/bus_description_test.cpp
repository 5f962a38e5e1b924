// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/can/bus_check_support.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tools/base/text/error.hpp"

#include <cmath>
#include <filesystem>

namespace {

using namespace dfdyn::tools;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::EndsWith;
using dfdyn::tests::bus_folder;
using dfdyn::tests::file_content;
using dfdyn::tests::TemporaryDirectory;

/// The example with one part of its text replaced.
BusDescription changed(const std::string& name, const std::string& from, const std::string& to) {
    std::string text = file_content(bus_folder + name);
    const std::size_t place = text.find(from);
    REQUIRE(place != std::string::npos);
    const TemporaryDirectory directory;
    return read_bus_description(directory.write("bus.json", text.replace(place, from.size(), to)));
}

/// An arm of Damiao motors. `scale`: fields of the first motor in addition to its addresses; `others`: all
/// fields of the others.
BusDescription damiao_arm(const std::string& scale, const std::string& others = "") {
    return dfdyn::tests::described(
        R"({"schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 500, "trigger": {"on": "set"},
            "joints": {"family": "damiao", "boards": [{"motor_id": 1, "feedback_id": "0x11", "joint": 1)" +
        scale + "}" + others + R"(]}, "output": {"family": "efforts", "quantity": "tau"}})");
}

std::string refusal_of_damiao_arm(const std::string& scale, const std::string& others = "") {
    try {
        damiao_arm(scale, others);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

/// TMAX assumed for the first motor.
double torque_max_of(const BusDescription& arm) {
    dfdyn::hal::Frame frame = dfdyn::hal::make_frame(0x11, 8);
    frame.data = {0x11, 0x90, 0, 0x80, 0x0C, 0x00};
    AnyBoard motor = arm.boards.front().board;
    return motor.decode(frame).joint[0].effort / (2 * 0xC00 / 4095.0 - 1);
}

} // namespace

TEST_CASE("every example of a bus description is valid") {
    int examples = 0;
    for (const auto& file : std::filesystem::directory_iterator(bus_folder)) {
        if (file.path().extension() == ".json") {
            CAPTURE(file.path());
            CHECK_NOTHROW(read_bus_description(file.path()));
            ++examples;
        }
    }
    CHECK(examples >= 5);
}

TEST_CASE("a bus description gives devices and rates and limits") {
    const BusDescription icub = read_bus_description(bus_folder + "icub_arm_strain.json");
    CHECK(icub.joint_count == 4);
    CHECK(icub.outputs == OutputKind::wrench);
    CHECK(icub.trigger == BusTrigger::set);
    CHECK(icub.sample_period_ns() == 1'000'000);
    CHECK(icub.joints.max_age_ns == 3'000'000);
    CHECK(icub.output_range[2].highest == 2000);
    CHECK(icub.pairing.delay_ns == 500'000);
    CHECK(icub.pairing.period_ns == 1'000'000);
    const BusDescription slow =
        changed("icub_arm_strain.json", "\"bit_rate\": 1000000", "\"bit_rate\": 600000");
    CHECK(slow.pairing.delay_ns == 833'333); // 2 x 135 and 2 x 115 bits
    CHECK(icub.boards.at(1).joint == std::array{2, 3});
    CHECK(icub.joint_limits.at(0).encoder == dfdyn::hal::Encoder::unknown);
    const BusDescription ur5 = changed("ur5_cia402.json", "\"cia402\"", R"("cia402", "encoder": "absolute")");
    CHECK(ur5.joint_limits.at(5).encoder == dfdyn::hal::Encoder::absolute);
    CHECK(ur5.joint_count == 6);
    CHECK(ur5.outputs == OutputKind::motor_current);
    CHECK(ur5.synchronous);
    CHECK_FALSE(ur5.sensor);
}

TEST_CASE("each joint of a bus description can have another encoder") {
    const BusDescription arm =
        changed("icub_arm_strain.json", "\"icub_two_joint_board\"",
                R"("icub_two_joint_board", "encoder": ["absolute", "unknown", "incremental", "absolute"])");
    CHECK(arm.joint_limits.at(0).encoder == dfdyn::hal::Encoder::absolute);
    CHECK(arm.joint_limits.at(1).encoder == dfdyn::hal::Encoder::unknown);
    CHECK(arm.joint_limits.at(2).encoder == dfdyn::hal::Encoder::incremental);
}

TEST_CASE("an impossible bus description is rejected with field and expected value and found value") {
    struct Wrong {
        const char* example;
        const char* from;
        const char* to;
        const char* message;
    };
    const auto [example, from, to, message] = GENERATE(values<Wrong>({
        {"ur5_cia402.json", "dfdyn.bus/1", "dfdyn.bus/2",
         R"(schema: expected "dfdyn.bus/1", found "dfdyn.bus/2")"},
        {"ur5_cia402.json", "cia402", "cia403",
         R"(joints.family: expected icub_two_joint_board, icub_2foc, cia402, odrive, damiao, robstride, piper, cubemars, rmd, moteus or dbc, found "cia403")"},
        {"ur5_cia402.json", "\"joint\": 6", "\"joint\": 5",
         "joints.boards: expected joints 1 to N, each once, found joint 6 after another one of that number"},
        {"ur5_cia402.json", "\"joint\": 2", "\"joint\": 7",
         "joints.boards: expected joints 1 to N, each once, found joint 2 missing"},
        {"ur5_cia402.json", "\"node\": 6", "\"node\": 5",
         "joints.boards: expected devices that do not share identifiers, found two that send 0x85"},
        {"ur5_cia402.json", "\"counts_per_turn\": 1048576", "\"counts_per_turn\": 0",
         "joints.boards[0].counts_per_turn: expected a number that is not 0, found 0.000000"},
        {"ur5_cia402.json", "\"0x280\"", "\"0x580\"",
         "joints.boards[0].node: expected PDOs with identifiers that CANopen leaves to them, and signals "
         "that "
         "fit, found others"},
        {"ur5_cia402.json", "\"0x280\"", "\"280\"",
         R"(joints.position.pdo: expected an identifier from "0x0" to "0x7FF", found "280")"},
        {"ur5_cia402.json", "\"cia402\"", R"("cia402", "encoder": "multi_turn")",
         R"(joints.encoder: expected "absolute", "incremental" or "unknown", found "multi_turn")"},
        {"ur5_cia402.json", "\"cia402\"", R"("cia402", "encoder": ["absolute"])",
         "joints.encoder: expected 6 texts, found 1"},
        {"ur5_icub_2foc.json", "\"set\"", "\"sync\"",
         R"(trigger.on: expected timer or set, because no joint measures at a SYNC, found "sync")"},
        {"icub_arm_strain.json", "icub_strain", "efforts",
         "output.field \"address\": expected one of family, quantity, limit, max_age_s, latency_s, jitter_s, "
         "frozen_after, found "
         "another"},
        {"icub_arm_strain.json",
         R"("icub_strain", "address": 13, "full_scale": [1500, 1500, 2000, 35, 35, 25])",
         R"("efforts", "quantity": "tau")",
         R"(output.family: expected a sensor, because the joints' boards send no efforts, found "efforts")"},
        {"icub_arm_strain.json", "[1500, 1500", "[32767, 1500",
         "output.full_scale: expected full scales that a sensor of an arm can have, N and N·m, found others"},
        {"icub_arm_strain.json", "\"address\": 13", "\"address\": 13, \"pair_window_s\": 0.001",
         "output.pair_window_s: expected less than a period of the sensor, 0.001, found 0.001"},
        {"icub_arm_strain.json", "\"address\": 13", "\"address\": 13, \"calibration_set\": 16",
         "output.calibration_set: expected a whole number from 0 to 15, found \"16\""},
        {"icub_arm_strain.json", "\"bit_rate\"", "\"bitrate\"",
         "field \"bitrate\": expected one of schema, bit_rate, data_bit_rate, sample_rate_hz, trigger, "
         "joints, output, "
         "found "
         "another (did you mean \"bit_rate\"?)"},
    }));
    CAPTURE(example, from, to);
    std::string found;
    try {
        changed(example, from, to);
    } catch (const InputError& error) {
        found = error.what();
    }
    CHECK_THAT(found, EndsWith(message));
}

TEST_CASE("a Damiao motor's scale is the factory setting of its type or the given one") {
    CHECK(torque_max_of(damiao_arm(R"(, "motor": "DM4310")")) == Approx(10));
    CHECK(torque_max_of(damiao_arm(R"(, "motor": "DM8009")")) == Approx(54));
    CHECK(torque_max_of(damiao_arm(R"(, "motor": "DM4310", "torque_max": 12)")) == Approx(12));
    CHECK(torque_max_of(damiao_arm(R"(, "motor": "DM4340", "velocity_max": 10)")) == Approx(28));
    CHECK(torque_max_of(damiao_arm(R"(, "position_max": 12.5, "velocity_max": 30, "torque_max": 4)")) ==
          Approx(4));
}

TEST_CASE("a Damiao motor's scale has no default if libraries disagree about it") {
    const std::string unsure = ", for which no default is sure, found none";
    CHECK_THAT(refusal_of_damiao_arm(R"(, "motor": "DM4340")"),
               EndsWith("joints.boards[0].velocity_max: expected the motor's register 22 (VMAX)" + unsure));
    CHECK_THAT(refusal_of_damiao_arm(R"(, "motor": "DM3507")"), EndsWith("register 22 (VMAX)" + unsure));
    CHECK_THAT(refusal_of_damiao_arm(R"(, "motor": "DM3507", "velocity_max": 50)"),
               EndsWith("joints.boards[0].torque_max: expected the motor's register 23 (TMAX)" + unsure));
    CHECK_THAT(refusal_of_damiao_arm(""), EndsWith("register 21 (PMAX)" + unsure));
    CHECK_THAT(refusal_of_damiao_arm(R"(, "motor": "DM4311")"), EndsWith("found \"DM4311\""));
    CHECK_THAT(refusal_of_damiao_arm(R"(, "motor": "DM4310")", R"(, {"motor_id": 2, "joint": 2})"),
               EndsWith("joints.boards[1].feedback_id: expected this field, found none"));
    CHECK_THAT(
        refusal_of_damiao_arm(R"(, "motor": "DM4310")",
                              R"(, {"motor_id": 1, "feedback_id": "0x11", "joint": 2, "motor": "DM4310"})"),
        EndsWith(
            "expected motors that differ in motor_id or feedback_id, found two with motor_id 1 on 0x11"));
    CHECK_THAT(
        refusal_of_damiao_arm(R"(, "motor": "DM4310")",
                              R"(, {"motor_id": 2, "feedback_id": "0x1", "joint": 2, "motor": "DM4310"})"),
        EndsWith("found answers on 0x1, which is motor_id 1"));
}

/// Error for an arm of one motor. `options`: fields of `joints`; `board`: fields of the motor.
std::string refusal_of_motor(const std::string& options, const std::string& board) {
    try {
        dfdyn::tests::described(
            R"({"schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 500, "trigger": {"on": "set"},
                "joints": {)" +
            options + R"(, "boards": [{"motor_id": 1, "joint": 1)" + board +
            R"(}]}, "output": {"family": "efforts", "quantity": "i"}})");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST_CASE("an option that has no meaning with the chosen protocol is rejected by its name") {
    struct Unused {
        const char* options;
        const char* board;
        const char* message;
    };
    const auto [options, board, message] = GENERATE(values<Unused>({
        {R"("family": "cubemars")", R"(, "motor": "AK80-9", "pole_pairs": 21)",
         R"(joints.boards[0].pole_pairs: expected no such field with protocol "mit", found one)"},
        {R"("family": "cubemars")", R"(, "motor": "AK80-9", "gear_ratio": 9)", "boards[0].gear_ratio: "},
        {R"("family": "cubemars")", R"(, "motor": "AK80-9", "newton_metre_per_ampere": 1)",
         "boards[0].newton_metre_per_ampere: "},
        {R"("family": "cubemars", "packet": "0x29")", R"(, "motor": "AK80-9")", "joints.packet: "},
        {R"("family": "cubemars", "protocol": "servo", "feedback_id": "0x0")", "", "joints.feedback_id: "},
        {R"("family": "cubemars", "protocol": "servo")", R"(, "feedback_id": "0x0")",
         R"(joints.boards[0].feedback_id: expected no such field with protocol "servo", found one)"},
        {R"("family": "cubemars", "protocol": "servo")", R"(, "motor": "AK80-9")", "boards[0].motor: "},
        {R"("family": "cubemars", "protocol": "servo")", R"(, "position_max": 12)",
         "boards[0].position_max: "},
        {R"("family": "cubemars", "protocol": "servo")", R"(, "velocity_max": 12)",
         "boards[0].velocity_max: "},
        {R"("family": "cubemars", "protocol": "servo")", R"(, "torque_max": 12)", "boards[0].torque_max: "},
        {R"("family": "robstride")", R"(, "motor": "RS03", "feedback_id": "0xFD")",
         R"(joints.boards[0].feedback_id: expected no such field with protocol "private", found one)"},
        {R"("family": "rmd")", R"(, "counts_per_turn": 65536)",
         R"(counts_per_turn: expected no such field with position other than "encoder", found one)"},
        {R"("family": "rmd", "position": "status")", R"(, "counts_per_turn": 65536)",
         "boards[0].counts_per_turn: "},
    }));
    CAPTURE(options, board);
    CHECK_THAT(refusal_of_motor(options, board), ContainsSubstring(message));
    CHECK(refusal_of_motor(R"("family": "rmd", "position": "encoder")", R"(, "counts_per_turn": 1000)")
              .empty());
}

TEST_CASE("buscheck finds that a Damiao motor's velocities have another scale than its positions") {
    const auto rules_with = [](double described_max, double true_max) {
        const BusDescription arm =
            damiao_arm(R"(, "motor": "DM4340", "velocity_max": )" + std::to_string(described_max));
        dfdyn::tests::Frames frames = dfdyn::tests::sound(arm, 12);
        const std::int64_t start_ns = frames.front().stamp_ns;
        for (dfdyn::hal::Frame& frame : frames) {
            const double velocity = 0.2 * std::cos(1e-9 * static_cast<double>(frame.stamp_ns - start_ns));
            const auto code = static_cast<unsigned>((velocity + true_max) / (2 * true_max) * 4095 + 0.5);
            frame.data[3] = static_cast<std::uint8_t>(code >> 4);
            frame.data[4] = static_cast<std::uint8_t>((code & 0xF) << 4 | (frame.data[4] & 0xF));
        }
        return dfdyn::tests::rules(arm, frames);
    };
    CHECK(rules_with(10, 10) == dfdyn::tests::Names{});
    CHECK(rules_with(10, 8) == dfdyn::tests::Names{"velocity_scale"});
    CHECK(rules_with(8, 10) == dfdyn::tests::Names{"velocity_scale"});
}
