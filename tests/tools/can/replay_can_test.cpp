// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tools/base/text/error.hpp"
#include "tools/can/log/bus_traffic.hpp"
#include "tools/replay/replay_can.hpp"
#include "tools/replay/replay_csv.hpp"

#include <algorithm>
#include <numbers>
#include <sstream>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::bus_folder;
using dfdyn::tests::file_content;
using dfdyn::tests::IcubLog;
using dfdyn::tests::TemporaryDirectory;
using dfdyn::tests::unlearned_model;

Recording read_no7(std::size_t rows) {
    ReadOptions options;
    options.joint_count = 6;
    options.outputs = OutputKind::motor_current;
    options.rows = {0, rows};
    return read_recording(DFDYN_TEST_DATA_DIR "/ur5_kufieta/Movement_No7_Acc_slow_Verify_Model_short.csv",
                          options);
}

TrainedModel ur5_model() {
    std::mt19937_64 engine(1);
    return unlearned_model(engine, 6, 0.008, output_names(OutputKind::motor_current, 6), 40);
}

double to_step(double value, double step) { return std::round(value / step) * step; }

/// Returns a recording quantised with these steps, from row `first` on.
Recording quantised(Recording recording, std::size_t first, double position_step, double output_step) {
    for (double& q : recording.position.values) {
        q = to_step(q, position_step);
    }
    for (double& y : recording.output.values) {
        y = to_step(y, output_step);
    }
    const auto cut = [first](auto& values, std::size_t width) {
        values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first * width));
    };
    cut(recording.time_s, 1);
    cut(recording.time_ns, 1);
    cut(recording.gap_before, 1);
    cut(recording.position.values, 6);
    cut(recording.output.values, 6);
    recording.gap_before.front() = 1;
    return recording;
}

ReplayedRecording replay_csv(const TrainedModel& model, const Recording& recording) {
    const auto estimator = make_estimator(model, true);
    return replay(*estimator, {&model, 1}, recording, 0, [](std::size_t) {});
}

ReplayedBus replay_can(const TrainedModel& model, const BusDescription& bus,
                       const std::filesystem::path& log) {
    const auto estimator = make_estimator(model, true);
    return replay_log(*estimator, {&model, 1}, bus, log, "", 0);
}

/// The first tick with a sample, and the number of consecutive samples from there.
std::pair<std::size_t, std::size_t> good_ticks(const ReplayedRecording& replayed) {
    const auto good = [](dfdyn::hal::Reason reason) { return reason == dfdyn::hal::Reason::ok; };
    const auto first = std::ranges::find_if(replayed.bus_reason, good);
    const auto last = std::find_if_not(first, replayed.bus_reason.end(), good);
    return {static_cast<std::size_t>(first - replayed.bus_reason.begin()),
            static_cast<std::size_t>(last - first)};
}

std::size_t learned(const ReplayedRecording& replayed) {
    return static_cast<std::size_t>(
        std::ranges::count_if(replayed.status, [](const dfdyn::Status& status) { return status.learned(); }));
}

bool predicted(const ReplayedRecording& replayed) {
    return std::ranges::any_of(replayed.status,
                               [](const dfdyn::Status& status) { return status.predicted(); });
}

/// The description without its full scales.
BusDescription without_full_scale() {
    std::string text = file_content(bus_folder + "icub_arm_strain.json");
    const std::size_t place = text.find(", \"full_scale\"");
    text = text.substr(0, place) + "}}";
    const TemporaryDirectory directory;
    return read_bus_description(directory.write("bus.json", text));
}

} // namespace

TEST_CASE(
    "a UR5's recording as six drives on a bus gives bit-identical predictions to the quantised recording") {
    const Recording recording = read_no7(1500);
    const BusDescription bus = read_bus_description(bus_folder + "ur5_cia402.json");
    const TemporaryDirectory directory;
    write_bus_log(recording, bus, {}, directory.path() / "run.log");
    const TrainedModel model = ur5_model();
    const ReplayedRecording can = replay_can(model, bus, directory.path() / "run.log").replayed;
    const auto [first, count] = good_ticks(can);
    CHECK(first == 9); // a source qualifies after ten readings
    REQUIRE(first + count == 1499);
    const ReplayedRecording csv =
        replay_csv(model, quantised(recording, first, 2 * std::numbers::pi / 1048576, 1e-3));
    REQUIRE(learned(csv) > 1000);
    for (std::size_t value = 0; value < 6 * count; ++value) {
        const float of_can = can.predicted[6 * first + value];
        const float of_csv = csv.predicted[value];
        CAPTURE(value / 6, of_can, of_csv);
        REQUIRE((of_can == of_csv || (std::isnan(of_can) && std::isnan(of_csv))));
    }
}

TEST_CASE("a log that was cut off in the middle of a line loses only that line") {
    const IcubLog log;
    std::string text = file_content(log.path);
    text.resize(text.size() - 8);
    const auto cut = log.directory.write("cut.log", text);
    CHECK(learned(replay_can(log.model, log.bus, cut).replayed) ==
          learned(replay_can(log.model, log.bus, log.path).replayed) - 1);
    text.insert(text.size() / 2, "\n(");
    const auto broken = log.directory.write("broken.log", text);
    CHECK_THROWS_WITH(replay_can(log.model, log.bus, broken),
                      Catch::Matchers::StartsWith(broken.string() + ":") &&
                          Catch::Matchers::ContainsSubstring("expected"));
}

TEST_CASE("a wrench is learned only if its full scales are on the bus") {
    const IcubLog log;
    const BusDescription bus = without_full_scale();
    const ReplayedRecording told = replay_can(log.model, bus, log.path).replayed;
    CHECK(learned(told) > 450);
    const ReplayedRecording untold = replay_can(log.model, bus, log.without(" 2D0#")).replayed;
    CHECK(predicted(untold));
    CHECK(learned(untold) == 0);
    std::ostringstream out;
    write_replay_csv(out, log.model, {&untold, 1});
    CHECK_THAT(out.str(), Catch::Matchers::EndsWith(",nan,0,waiting_for_full_scale\n"));
}

TEST_CASE("a frame stamped an hour ahead is left out, counted and printed") {
    const IcubLog log;
    std::string text = file_content(log.path);
    const std::string second = "(0000000000.26";
    text.replace(text.find(second), second.size(), "(0000003600.26");
    const ReplayedBus replayed = replay_can(log.model, log.bus, log.directory.write("ahead.log", text));
    CHECK(replayed.bus.strays == 1);
    CHECK(learned(replayed.replayed) > 450);
    std::ostringstream out;
    print_bus(out, replayed.bus);
    CHECK_THAT(out.str(), Catch::Matchers::ContainsSubstring(
                              "1 x frames left out, with stamps ahead of those after them\n"));
}

TEST_CASE("joints on other identifiers give no sample and are named") {
    const IcubLog log;
    std::string text = file_content(bus_folder + "icub_arm_strain.json");
    text.replace(text.find("\"address\": 2"), 12, "\"address\": 7");
    const ReplayedBus replayed =
        replay_can(log.model, read_bus_description(log.directory.write("bus.json", text)), log.path);
    CHECK_FALSE(predicted(replayed.replayed));
    CHECK(reason_name(replayed.replayed, 100) == "waiting_for_position");
    CHECK(replayed.bus.unknown.count() == 500);
    CHECK(replayed.bus.unknown.first().id == 0x121);
}

TEST_CASE("a silent sensor ends the learning but not the prediction") {
    const IcubLog log;
    std::istringstream lines(file_content(log.path));
    std::string text;
    for (std::string line; std::getline(lines, line);) {
        const bool sensor =
            line.find(" 3DA#") != std::string::npos || line.find(" 3DB#") != std::string::npos;
        text += sensor && line > "(0000000000.260000000)" ? "" : line + "\n";
    }
    const BusDescription bus = read_bus_description(bus_folder + "icub_arm_strain.json");
    const ReplayedRecording replayed =
        replay_can(log.model, bus, log.directory.write("silent.log", text)).replayed;
    CHECK(learned(replayed) > 220);
    CHECK(learned(replayed) < 250);
    REQUIRE(replayed.status.size() > 480);
    CHECK(replayed.status.back().predicted());
    CHECK(reason_name(replayed, replayed.status.size() - 1) == "output_stale");
    CHECK(std::isnan(replayed.measured.back()));
}

TEST_CASE("a description that does not fit the model is rejected") {
    const IcubLog log;
    BusDescription bus = read_bus_description(bus_folder + "icub_arm_strain.json");
    bus.source = "bus.json";
    bus.sample_rate_hz = 100;
    CHECK_THROWS_WITH(replay_can(log.model, bus, log.path),
                      "bus.json: sample_rate_hz: expected 1000, as of the model, found 100");
    CHECK_THROWS_WITH(replay_can(ur5_model(), bus, log.path),
                      "bus.json: joints: expected 6, as of the model, found 4");
}

TEST_CASE("a log whose clock was set back is learned except for the frames until the new clock is adopted") {
    IcubLog log;
    std::istringstream lines(file_content(log.path));
    std::string text;
    int number = 0;
    for (std::string line; std::getline(lines, line); ++number) { // "(0.010130000) can0 …", 4 frames a row
        const std::size_t point = line.find('.');
        const int seconds = std::stoi(line.substr(1, point - 1)) + (number < 1000 ? 10 : 0);
        text += "(" + std::to_string(seconds) + line.substr(point) + "\n";
    }
    const std::size_t steady = learned(replay_can(log.model, log.bus, log.path).replayed);
    const std::size_t set_back =
        learned(replay_can(log.model, log.bus, log.directory.write("set_back.log", text)).replayed);
    CHECK(steady > 480);
    CHECK(set_back < steady);
    // 20 frames until the clock is adopted, ten readings to qualify again, and the lag window
    CHECK(set_back > steady - 30);
}
