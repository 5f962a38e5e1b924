// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tools/base/text/error.hpp"
#include "tools/can/arm/bus_sampler.hpp"
#include "tools/can/log/bus_traffic.hpp"

#include <numbers>

namespace {

using namespace dfdyn::tools;
using dfdyn::hal::Frame;
using dfdyn::tests::bus_folder;
using dfdyn::tests::file_content;
using dfdyn::tests::TemporaryDirectory;

struct Row {
    std::int64_t time_ns;
    std::vector<double> position;
    std::vector<double> output;
};

std::vector<Row> random_rows(std::mt19937_64& engine, std::size_t count, std::int64_t period_ns,
                             std::size_t joints, const std::vector<double>& output_range) {
    std::uniform_real_distribution<double> within(-1, 1);
    const double slow = 2 + within(engine); // rad/s
    const double phase = 3 * within(engine);
    std::vector<Row> rows;
    for (std::size_t k = 0; k < count; ++k) {
        Row row{static_cast<std::int64_t>(k) * period_ns, {}, {}};
        for (std::size_t i = 0; i < joints; ++i) {
            const double t = 1e-9 * static_cast<double>(row.time_ns);
            row.position.push_back(1.5 * std::sin(slow * t + phase + static_cast<double>(i)));
        }
        for (const double range : output_range) {
            row.output.push_back(0.99 * range * within(engine));
        }
        rows.push_back(row);
    }
    return rows;
}

std::vector<Frame> frames_of(const std::vector<Row>& rows, const BusDescription& description,
                             const TrafficOptions& options) {
    std::vector<Frame> frames;
    BusTraffic traffic(description, options, [&](const Frame& frame) { frames.push_back(frame); });
    for (const Row& row : rows) {
        traffic.add(row.time_ns, row.position, row.output);
    }
    traffic.finish();
    return frames;
}

std::vector<BusSample> samples_of(const std::vector<Frame>& frames, const BusDescription& description) {
    std::vector<BusSample> samples;
    BusSampler sampler(description, [&](const BusSample& sample) { samples.push_back(sample); });
    for (const Frame& frame : frames) {
        sampler.take(frame, {}, {});
    }
    return samples;
}

constexpr std::size_t qualification = 10; ///< readings until a source qualifies

Frame frame_of(std::uint32_t id, int length) { return dfdyn::hal::make_frame(id, length); }

} // namespace

TEST_CASE("frames have their worst-case bits: 55 + 10 per byte and 25 more with a 29-bit identifier") {
    CHECK(frame_bits(frame_of(1, 0)) == 55);
    CHECK(frame_bits(frame_of(1, 8)) == 135);
    Frame frame = frame_of(1, 8);
    frame.extended = true;
    CHECK(frame_bits(frame) == 160);
}

TEST_CASE("a CAN FD frame has its data at the data bit rate if it switches") {
    Frame frame = frame_of(1, 8);
    frame.fd = true;
    // ISO 11898-1: 17 bits with 4 stuff bits, 13 at the end; 69 with 17, stuff count 4, CRC of 17 with 6
    // fixed stuff bits
    const double arbitration = 17 + 4 + 13;
    const double data = 69 + 17 + 4 + 17 + 6;
    CHECK(frame_bits(frame, 5) == Approx(arbitration + data));
    frame.bit_rate_switch = true;
    CHECK(frame_bits(frame, 5) == Approx(arbitration + data / 5));
    frame.length = 64; // a CRC of 21 bits
    CHECK(frame_bits(frame, 5) == Approx(arbitration + (517 + 129 + 4 + 21 + 7) / 5.0));
}

TEST_CASE("a wire carries one frame at a time and first the waiting frame with the lowest identifier") {
    std::vector<std::pair<std::uint32_t, std::int64_t>> sent;
    BusWire wire(1e6, [&](const Frame& frame) { sent.emplace_back(frame.id, frame.stamp_ns); });
    wire.offer(frame_of(0x300, 0), 0);
    wire.offer(frame_of(0x200, 0), 1000);
    wire.offer(frame_of(0x100, 0), 2000);
    wire.offer(frame_of(0x400, 0), 3000);
    wire.offer(frame_of(0x050, 0), 900'000);
    wire.send_before(500'000);
    CHECK(sent.size() == 4);
    wire.send_all();
    CHECK(sent ==
          std::vector<std::pair<std::uint32_t, std::int64_t>>{
              {0x300, 55'000}, {0x100, 110'000}, {0x200, 165'000}, {0x400, 220'000}, {0x50, 955'000}});
    CHECK(wire.bits() == 5 * 55);
}

TEST_CASE("rows converted to frames and back are equal to half a count: drives with SYNC") {
    DFDYN_SEEDED_ENGINE(engine);
    const BusDescription description = read_bus_description(bus_folder + "ur5_cia402.json");
    const std::vector<Row> rows = random_rows(engine, 200, 8'000'000, 6, std::vector<double>(6, 30));
    const double jitter_us = GENERATE(0.0, 700.0);
    const std::vector<BusSample> samples =
        samples_of(frames_of(rows, description, {jitter_us, 3}), description);
    REQUIRE(samples.size() == rows.size() - 1); // the last row waits for the SYNC after it
    for (std::size_t k = 0; k < samples.size(); ++k) {
        CAPTURE(k, samples[k].report.position, samples[k].report.output);
        REQUIRE(samples[k].sample.output_valid == (k + 1 >= qualification));
        if (!samples[k].sample.output_valid) {
            continue;
        }
        CHECK(samples[k].sample.time_ns == rows[k].time_ns + BusTraffic::lead_ns + 55'000); // end of the SYNC
        for (std::size_t i = 0; i < 6; ++i) {
            CHECK(std::abs(samples[k].positions()[i] - rows[k].position[i]) <=
                  std::numbers::pi / 1048576 + 1e-12);
            CHECK(std::abs(samples[k].valid_outputs()[i] - rows[k].output[i]) <= 0.5e-3 + 1e-12);
        }
    }
}

TEST_CASE("rows converted to frames and back are equal to half a count: boards and a sensor") {
    DFDYN_SEEDED_ENGINE(engine);
    const BusDescription description = read_bus_description(bus_folder + "icub_arm_strain.json");
    const std::vector<double> full_scale{1500, 1500, 2000, 35, 35, 25};
    const std::vector<Row> rows = random_rows(engine, 300, 1'000'000, 4, full_scale);
    const std::vector<BusSample> samples = samples_of(frames_of(rows, description, {}), description);
    // A sample has the time of the wrench's first half. Positions come before it, so they are those of the
    // same row.
    std::size_t row = 0;
    std::size_t valid = 0;
    for (const BusSample& sample : samples) {
        if (!sample.sample.output_valid) {
            continue;
        }
        while (rows[row].time_ns + BusTraffic::lead_ns + 1'000'000 <= sample.sample.time_ns) {
            ++row;
        }
        CAPTURE(row);
        ++valid;
        for (std::size_t i = 0; i < 4; ++i) {
            const double half_tick = 0.5 / 11.375 * std::numbers::pi / 180;
            CHECK(std::abs(sample.positions()[i] - rows[row].position[i]) <= half_tick + 1e-12);
        }
        for (std::size_t k = 0; k < 6; ++k) {
            CHECK(std::abs(sample.valid_outputs()[k] - rows[row].output[k]) <=
                  0.5 * full_scale[k] / 32768 + 1e-9);
        }
    }
    CHECK(valid == rows.size() - qualification + 1);
}

TEST_CASE("equal seeds give equal frames and different seeds different ones") {
    DFDYN_SEEDED_ENGINE(engine);
    const BusDescription description = read_bus_description(bus_folder + "icub_arm_strain.json");
    const std::vector<Row> rows = random_rows(engine, 50, 1'000'000, 4, std::vector<double>(6, 10));
    const auto stamps = [&](std::uint64_t seed) {
        std::vector<std::int64_t> result;
        for (const Frame& frame : frames_of(rows, description, {200, seed})) {
            result.push_back(frame.stamp_ns);
        }
        return result;
    };
    CHECK(stamps(5) == stamps(5));
    CHECK(stamps(5) != stamps(6));
}

TEST_CASE("a bus that cannot carry the frames and rows that are too slow for it are rejected") {
    DFDYN_SEEDED_ENGINE(engine);
    BusDescription description = read_bus_description(bus_folder + "icub_arm_strain.json");
    description.source = "bus.json";
    const std::vector<Row> rows = random_rows(engine, 1000, 1'000'000, 4, std::vector<double>(6, 10));
    // 2 frames of 8 bytes and 2 of 6 bytes have 500 bits per millisecond
    description.bit_rate = 510'000;
    CHECK_NOTHROW(frames_of(rows, description, {}));
    description.bit_rate = 490'000;
    CHECK_THROWS_WITH(
        frames_of(rows, description, {}),
        Catch::Matchers::StartsWith("bus.json: bit_rate: expected a bus that carries all frames, "
                                    "found a load of 102"));
    const std::vector<Row> slow = random_rows(engine, 100, 50'000'000, 4, std::vector<double>(6, 10));
    CHECK_THROWS_WITH(frames_of(slow, read_bus_description(bus_folder + "icub_arm_strain.json"), {}),
                      Catch::Matchers::EndsWith("expected up to 20, the mean rate of the rows, found 1000"));
}
