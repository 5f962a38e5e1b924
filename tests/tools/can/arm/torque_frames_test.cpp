// SPDX-License-Identifier: Apache-2.0
#include "tools/can/arm/torque_frames.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/random_frame.hpp"
#include "tests/support/seed.hpp"

#include <random>
#include <vector>

namespace {

using namespace dfdyn::tools;

BusDescription description(const std::string& name) {
    return read_bus_description(DFDYN_TEST_DATA_DIR "/can/" + name);
}

} // namespace

TEST_CASE("torques are sent to CiA 402 drives as their target torque") {
    TorqueFrames frames(description("ur5_loop.json"));
    const std::vector<double> torque{1, -2, 150, -150, 0.01, 400};
    const auto sent = frames.encode(torque);
    REQUIRE(sent.size() == 6);
    CHECK(sent[0].id == 0x201);
    CHECK(sent[0].length == 2);
    CHECK(sent[0].data[0] == 100); // 1 N·m in units of 0.01
    CHECK(sent[0].data[1] == 0);
    CHECK(sent[1].data[0] == 0x38); // -200
    CHECK(sent[1].data[1] == 0xFF);
    CHECK(sent[5].data[0] == 0xFF); // saturated to 16 bits
    CHECK(sent[5].data[1] == 0x7F);
}

TEST_CASE("torques are sent to other boards in frames of our own") {
    TorqueFrames frames(description("icub_loop.json"));
    const auto sent = frames.encode(std::vector<double>{1, -2, 0.5, 0});
    REQUIRE(sent.size() == 2);
    CHECK(sent[0].id == 0x1DFD000);
    CHECK(sent[0].extended);
    const std::vector<std::uint8_t> expected{0, 0, 0x80, 0x3F, 0, 0, 0, 0xC0}; // 1.0F, -2.0F
    CHECK(std::vector<std::uint8_t>(sent[0].data.begin(), sent[0].data.begin() + 8) == expected);
}

TEST_CASE("torque commands are decoded as they were encoded and foreign frames are ignored") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_real_distribution<double> uniform(-100, 100);
    for (const char* const name : {"ur5_loop.json", "icub_loop.json"}) {
        TorqueFrames frames(description(name));
        std::vector<double> torque(static_cast<std::size_t>(description(name).joint_count));
        for (double& one : torque) {
            one = uniform(engine);
        }
        std::vector<double> taken(torque.size(), 0);
        for (const dfdyn::hal::Frame& frame : frames.encode(torque)) {
            CHECK(frames.take(frame, taken));
        }
        for (std::size_t i = 0; i < torque.size(); ++i) {
            CHECK(taken[i] == Approx(torque[i]).margin(0.0051));
        }
        const std::vector<double> before = taken;
        for (int trial = 0; trial < 2000; ++trial) {
            const dfdyn::hal::Frame frame = dfdyn::tests::random_frame(engine);
            CHECK(frames.take(frame, taken) == (taken != before));
            taken = before;
        }
    }
}

TEST_CASE("a torque that is not a number is not accepted") {
    TorqueFrames frames(description("icub_loop.json"));
    std::vector<double> taken(4, 3);
    dfdyn::hal::Frame frame = frames.encode(std::vector<double>{1, 2, 3, 4})[0];
    frame.data[2] = 0xC0;
    frame.data[3] = 0x7F; // NaN
    CHECK_FALSE(frames.take(frame, taken));
    CHECK(taken == std::vector<double>(4, 3));
}
