// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/suites/hour_bench.hpp"

#include "tools/base/recording/csv_writer.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/base/system/atomic_file.hpp"
#include "tools/base/system/remove_on_signal.hpp"
#include "tools/bench/suites/bench_arm.hpp"
#include "tools/replay/replay.hpp"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <unistd.h>

namespace dfdyn::tools {

namespace {

constexpr int joints = BenchArm::joints;

void write_recording(const std::filesystem::path& path, std::size_t rows) {
    std::vector<std::string> columns{"t"};
    std::ranges::copy(joint_names("q", joints), std::back_inserter(columns));
    std::ranges::copy(joint_names("tau", joints), std::back_inserter(columns));
    AtomicFile file(path);
    CsvWriter writer(file.stream(), columns);
    BenchArm arm;
    for (std::size_t row = 0; row < rows; ++row) {
        arm.move_to(row);
        writer.field(arm.time_s()).fields(arm.position()).fields(arm.torque()).end_row();
    }
    file.commit();
}

/// Removes the file on destruction, or when the program is aborted.
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

/// CPU time of this thread, s: excludes other processes on a shared machine.
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
    const TrainedModel model = BenchArm::model();
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
