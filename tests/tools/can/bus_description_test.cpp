// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tools/base/text/error.hpp"

#include <filesystem>

namespace {

using namespace dfdyn::tools;
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

} // namespace

TEST_CASE("every example of a bus description can be read") {
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

TEST_CASE("a bus description says what is on the bus") {
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
    const BusDescription ur5 = read_bus_description(bus_folder + "ur5_cia402.json");
    CHECK(ur5.joint_count == 6);
    CHECK(ur5.outputs == OutputKind::motor_current);
    CHECK(ur5.synchronous);
    CHECK_FALSE(ur5.sensor);
}

TEST_CASE("what a bus description cannot be is refused by field, expectation and finding") {
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
         R"(joints.family: expected icub_two_joint_board, icub_2foc, cia402, odrive or dbc, found "cia403")"},
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
         "field \"bitrate\": expected one of schema, bit_rate, sample_rate_hz, trigger, joints, output, "
         "found "
         "another"},
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
