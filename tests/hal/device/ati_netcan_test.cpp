// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/ati_netcan.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <limits>

namespace ati_netcan_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using Kind = Decoded::Kind;

/// Fx is 2 x gauge 0 - gauge 5; every other axis is its own gauge. 100 counts per N, 1000 per N·m.
AtiNetcan::Config plain_config() {
    AtiNetcan::Config config;
    for (std::size_t i = 0; i < 6; ++i) {
        config.matrix[i][i] = i == 0 ? 2 : 1;
    }
    config.matrix[0][5] = -1;
    config.counts_per_newton = 100;
    config.counts_per_newton_metre = 1000;
    return config;
}

// status 0; gauges 0 2 4: 300, -2, 1000; gauges 1 3 5: 0x0102, -1000, 100
const Frame first_frame = frame_of(0x200, {0x00, 0x00, 0x01, 0x2C, 0xFF, 0xFE, 0x03, 0xE8});
const Frame second_frame = frame_of(0x201, {0x01, 0x02, 0xFC, 0x18, 0x00, 0x64});

Frame with_status(std::uint8_t high, std::uint8_t low) {
    Frame frame = first_frame;
    frame.data[0] = high;
    frame.data[1] = low;
    return frame;
}

TEST_CASE("an ATI sensor's gauges become a wrench by its matrix") {
    const AtiNetcan sensor(plain_config());
    CHECK(sensor.calibration() == Reason::ok);
    CHECK(sensor.decode(first_frame).part == 0);
    CHECK(sensor.decode(second_frame).part == 1);
    const WrenchReading reading = sensor.wrench(first_frame, second_frame);
    CHECK(reading.reason == Reason::ok);
    CHECK(reading.raw == std::array<std::int32_t, 6>{300, 0x0102, -2, -1000, 1000, 100});
    const Wrench expected{5, 2.58, -0.02, -1, 1, 0.1};
    for (std::size_t k = 0; k < 6; ++k) {
        CHECK(reading.value[k] == Approx(expected[k]));
    }
}

TEST_CASE("an ATI sensor's fault bits reject the wrench") {
    const AtiNetcan sensor(plain_config());
    for (int bit = 0; bit < 16; ++bit) {
        const auto high = static_cast<std::uint8_t>(bit >= 8 ? 1 << (bit - 8) : 0);
        const auto low = static_cast<std::uint8_t>(bit < 8 ? 1 << bit : 0);
        const bool fault = bit == 15 || bit == 14 || bit == 12 || bit == 11 || (bit >= 3 && bit <= 7);
        CHECK(sensor.wrench(with_status(high, low), second_frame).reason ==
              (fault ? Reason::device_fault : Reason::ok));
    }
}

TEST_CASE("an ATI sensor without a valid calibration gives no wrench") {
    AtiNetcan::Config config = plain_config();
    config.counts_per_newton = 0;
    CHECK(AtiNetcan(config).wrench(first_frame, second_frame).reason == Reason::waiting_for_full_scale);
    config.counts_per_newton = -1;
    CHECK(AtiNetcan(config).wrench(first_frame, second_frame).reason == Reason::full_scale_implausible);
    config = plain_config();
    config.matrix[3] = {};
    CHECK(AtiNetcan(config).wrench(first_frame, second_frame).reason == Reason::full_scale_implausible);
    config.matrix[3][0] = std::numeric_limits<double>::quiet_NaN();
    CHECK(AtiNetcan(config).calibration() == Reason::full_scale_implausible);
}

TEST_CASE("a poll of an ATI sensor is ignored and its frames have fixed lengths") {
    const AtiNetcan sensor(plain_config());
    CHECK(sensor.poll().id == 0x200);
    CHECK(sensor.poll().length == 0);
    CHECK(sensor.decode(sensor.poll()).kind == Kind::nothing);
    CHECK(rejects_malformed(sensor, first_frame, {0, 8}));
    CHECK(rejects_malformed(sensor, second_frame, {6}));
    CHECK(sensor.decode(frame_of(0x202, {0, 0, 0, 0, 0, 0, 0, 0})).kind == Kind::nothing);
}

TEST_CASE("a simulated ATI sensor's wrench is decoded to within the resolution of its gauges") {
    DFDYN_SEEDED_ENGINE(engine);
    const AtiNetcan sensor(plain_config());
    std::uniform_real_distribution<double> share(-1, 1);
    for (int i = 0; i < 1000; ++i) {
        Wrench value{};
        for (std::size_t k = 0; k < 6; ++k) {
            value[k] = share(engine) * (k < 3 ? 300 : 30);
        }
        const FrameList sent = sensor.encode(value);
        REQUIRE(sensor.decode(sent.frame[1]).part == 1);
        const WrenchReading reading = sensor.wrench(sent.frame[0], sent.frame[1]);
        for (std::size_t k = 0; k < 6; ++k) {
            const double counts = k == 0 ? 1.5001 : 0.5001;
            REQUIRE(std::abs(reading.value[k] - value[k]) <= counts / (k < 3 ? 100 : 1000));
        }
    }
    const FrameList overload = sensor.encode({0, 400, 0, 0, 0, 0});
    CHECK(sensor.wrench(overload.frame[0], overload.frame[1]).raw[1] == 32767);
}

} // namespace ati_netcan_test
