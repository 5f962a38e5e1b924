// SPDX-License-Identifier: Apache-2.0
// Recordings with uneven steps, and with all common rates, put on a bus and read back.
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tools/base/recording/sample_grid.hpp"
#include "tools/replay/replay_can.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace bus_clock_test {

using namespace dfdyn::tools;
using dfdyn::tests::TemporaryDirectory;
using dfdyn::tests::unlearned_model;

/// One oscillating joint at these times, with its current.
Recording swinging(const std::vector<std::int64_t>& times_ns) {
    Recording recording;
    recording.source = "made up";
    recording.position.names = joint_names("q", 1);
    recording.output.names = output_names(OutputKind::motor_current, 1);
    for (const std::int64_t time_ns : times_ns) {
        const double time_s = 1e-9 * static_cast<double>(time_ns);
        recording.time_ns.push_back(time_ns);
        recording.time_s.push_back(time_s);
        recording.gap_before.push_back(recording.gap_before.empty() ? 1 : 0);
        recording.position.values.push_back(std::sin(3 * time_s));
        recording.output.values.push_back(2 * std::cos(3 * time_s));
    }
    return recording;
}

/// One CiA 402 drive with this rate.
BusDescription one_drive(const TemporaryDirectory& directory, double rate_hz) {
    std::ostringstream text;
    text << std::setprecision(12) << R"({"schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": )"
         << rate_hz << R"(, "trigger": {"on": "sync"}, "joints": {"family": "cia402",
          "position": {"pdo": "0x280", "length": 6, "start_bit": 0, "bits": 32},
          "effort": {"pdo": "0x280", "length": 6, "start_bit": 32, "bits": 16},
          "boards": [{"node": 1, "joint": 1, "counts_per_turn": 1048576, "effort_per_count": 0.001}]},
          "output": {"family": "efforts", "quantity": "i"}})";
    return read_bus_description(directory.write("bus.json", text.str()));
}

/// Number of predicted ticks after the recording was put on a bus at its own rate and replayed.
std::ptrdiff_t predicted_over_bus(const Recording& recording) {
    const TemporaryDirectory directory;
    const double period_s = sample_period_s({&recording, 1});
    const BusDescription bus = one_drive(directory, 1 / period_s);
    write_bus_log(recording, bus, {}, directory.path() / "run.log");
    std::mt19937_64 engine(1);
    const TrainedModel model = unlearned_model(engine, 1, period_s, recording.output.names, 10);
    const auto estimator = make_estimator(model, true);
    const ReplayedRecording replayed =
        replay_log(*estimator, {&model, 1}, bus, directory.path() / "run.log", "", 0).replayed;
    return std::ranges::count_if(replayed.status,
                                 [](const dfdyn::Status& status) { return status.predicted(); });
}

constexpr int rows = 600;
// readings until a source qualifies, lags, and the SYNC after the last row
constexpr int unpredicted = 10 + 4 + 1;

TEST_CASE("a recording of any rate from 50 Hz to 5 kHz is unchanged by a bus") {
    for (const std::int64_t period_ns : {20'000'000, 8'000'000, 2'000'000, 1'000'000, 200'000}) {
        std::vector<std::int64_t> times_ns;
        for (int row = 0; row < rows; ++row) {
            times_ns.push_back(row * period_ns);
        }
        CHECK(predicted_over_bus(swinging(times_ns)) == rows - unpredicted);
    }
}

TEST_CASE("a recording with steps of 10 and 12 ms loses no tick on a bus") {
    for (const int every : {2, 3}) { // every second or third step is 12 ms
        std::vector<std::int64_t> times_ns{0};
        for (int row = 1; row < rows; ++row) {
            times_ns.push_back(times_ns.back() + (row % every == 0 ? 12'000'000 : 10'000'000));
        }
        CHECK(predicted_over_bus(swinging(times_ns)) == rows - unpredicted);
    }
}

TEST_CASE("jitter of a third of a period causes no lost tick on a bus") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_int_distribution<std::int64_t> jitter(0, 660'000);
    for (const std::int64_t period_ns : {8'000'000, 1'000'000}) {
        std::vector<std::int64_t> times_ns;
        for (int row = 0; row < rows; ++row) {
            times_ns.push_back(row * period_ns + jitter(engine) * period_ns / 1'000'000);
        }
        CHECK(predicted_over_bus(swinging(times_ns)) >= rows - unpredicted);
    }
}

} // namespace bus_clock_test
