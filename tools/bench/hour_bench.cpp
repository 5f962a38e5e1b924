// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/hour_bench.hpp"

#include "tools/common/atomic_file.hpp"
#include "tools/common/remove_on_signal.hpp"
#include "tools/evaluation/replay.hpp"
#include "tools/recording/csv_writer.hpp"
#include "tools/recording/recording.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <random>
#include <unistd.h>

namespace dfdyn::tools {

namespace {

constexpr int joints = 6;
constexpr int lags = 10;
constexpr int features = 100; // 2d = 200
constexpr double period_s = 0.001;

std::vector<double> random_numbers(std::mt19937_64& engine, std::size_t count, double deviation) {
    std::normal_distribution<double> normal(0, deviation);
    std::vector<double> numbers(count);
    std::ranges::generate(numbers, [&] { return normal(engine); });
    return numbers;
}

TrainedModel make_model() {
    std::mt19937_64 engine(4);
    TrainedModel model;
    model.joints = joints;
    model.sample_period_s = period_s;
    model.input.lags = lags;
    model.input.rows_per_joint = 3;
    model.input.rows = random_numbers(engine, 3 * (lags + 1), 0.3);
    model.input.scale.assign(3 * joints, 1.0);
    model.features = {false, features, 4, random_numbers(engine, features * 3 * joints, 1), 4};
    model.outputs = {joint_names("tau", joints), std::vector<double>(joints, 0.0),
                     std::vector<double>(joints, 0.1), 100};
    model.limits = {std::vector<double>(joints, 10.0), std::vector<double>(joints, 1e3), 1e9, 0};
    return model;
}

/// A joint's position and a torque that depends on it and on how it moves.
void write_recording(const std::filesystem::path& path, std::size_t rows) {
    std::vector<std::string> columns{"t"};
    std::ranges::copy(joint_names("q", joints), std::back_inserter(columns));
    std::ranges::copy(joint_names("tau", joints), std::back_inserter(columns));
    AtomicFile file(path);
    CsvWriter writer(file.stream(), columns);
    for (std::size_t row = 0; row < rows; ++row) {
        const double t = period_s * static_cast<double>(row);
        std::vector<double> position;
        std::vector<double> torque;
        for (int i = 0; i < joints; ++i) {
            const double pace = 0.3 + 0.17 * i;
            position.push_back(std::sin(pace * t) + 0.5 * std::sin(2.7 * pace * t));
            torque.push_back(5 * std::sin(position.back()) + 0.3 * std::cos(pace * t));
        }
        writer.field(t).fields(position).fields(torque).end_row();
    }
    file.commit();
}

/// Removes the file when it goes, or when the program is ended.
struct TemporaryFile {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("dfdyn-bench-" + std::to_string(::getpid()) + ".csv");
    RemoveOnSignal on_signal{path.string()};
    TemporaryFile() = default;
    ~TemporaryFile() {
        std::error_code ignored;
        std::filesystem::remove(path, ignored);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
};

/// Of this thread on its core, s: what others do on a shared machine is left out.
double core_time() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

template <class Work>
double seconds(const Work& work) {
    const double begin = core_time();
    work();
    return core_time() - begin;
}

} // namespace

HourBench run_hour_bench(std::size_t rows, const std::function<void(double)>& on_share_done) {
    constexpr std::size_t horizon = 25; // as `dfdyn replay` without --horizon
    const TrainedModel model = make_model();
    const TemporaryFile file;
    HourBench bench;
    bench.rows = rows;
    write_recording(file.path, rows);
    on_share_done(0.3);
    Recording recording;
    bench.read_s = seconds([&] {
        recording = read_recording(file.path, {.joint_count = joints, .outputs = OutputKind::joint_torque});
    });
    on_share_done(0.5);
    const auto replay_seconds = [&](std::size_t index_horizon) {
        const auto estimator = make_estimator(model, true);
        return seconds([&] {
            const ReplayedRecording replayed =
                replay(*estimator, {&model, 1}, recording, index_horizon, [](std::size_t) {});
            bench.learned = static_cast<std::size_t>(std::ranges::count_if(
                replayed.status, [](const Status& status) { return status.learning == Reason::ok; }));
        });
    };
    bench.ticks_only_s = replay_seconds(0);
    on_share_done(0.7);
    bench.replay_s = replay_seconds(horizon);
    return bench;
}

} // namespace dfdyn::tools
