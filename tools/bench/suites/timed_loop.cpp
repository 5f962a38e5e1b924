// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/suites/timed_loop.hpp"

#include "tools/base/system/real_time.hpp"
#include "tools/base/text/error.hpp"

#include <chrono>
#include <cmath>
#include <thread>

#include <sched.h>

namespace dfdyn::tools {

namespace {

constexpr std::size_t load_values = std::size_t{8} << 20; // 64 MiB: more than the caches hold
constexpr double longest_s = 3600;
constexpr double us_per_ns = 1e-3;

std::vector<int> cores_of_this_thread() {
    cpu_set_t set;
    CPU_ZERO(&set);
    ::sched_getaffinity(0, sizeof set, &set);
    std::vector<int> cores;
    for (int core = 0; core < CPU_SETSIZE; ++core) {
        if (CPU_ISSET(core, &set)) {
            cores.push_back(core);
        }
    }
    return cores;
}

void keep_this_thread_on(int core) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(core, &set);
    ::sched_setaffinity(0, sizeof set, &set);
}

/// Reads and writes more memory than the caches hold, until `stop` is requested.
void work(const std::stop_token& stop, int core) {
    keep_this_thread_on(core);
    std::vector<double> values(load_values, 1.0);
    while (!stop.stop_requested()) {
        for (double& value : values) {
            value = 0.999 * value + 0.001;
        }
    }
}

std::int64_t now_ns() {
    return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

void run(const TimedLoopOptions& options, const std::function<void(std::size_t)>& tick, TimedLoop& timed) {
    timed.not_real_time = become_real_time();
    Pace pace(now_ns(), std::llround(options.period_s * 1e9));
    for (std::size_t i = 0; i < timed.late_us.size(); ++i) {
        while (now_ns() < pace.due_ns()) { // a signal ends a sleep early
            sleep_until(pace.due_ns());
        }
        const std::int64_t begun_ns = now_ns();
        timed.late_us[i] = us_per_ns * static_cast<double>(begun_ns - pace.due_ns());
        pace.begin(begun_ns);
        tick(i);
        const std::int64_t ended_ns = now_ns();
        timed.duration_us[i] = us_per_ns * static_cast<double>(ended_ns - begun_ns);
        pace.end(ended_ns);
    }
    timed.pace = pace.counters();
}

} // namespace

TimedLoop time_loop(const TimedLoopOptions& options, const std::function<void(std::size_t)>& tick) {
    if (!(options.period_s > 0 && options.period_s <= options.duration_s &&
          options.duration_s <= longest_s)) {
        throw InputError("timed loop: expected 0 < period <= duration <= 3600 s, found a period of " +
                         std::to_string(options.period_s) + " s and a duration of " +
                         std::to_string(options.duration_s) + " s");
    }
    const std::vector<int> cores = cores_of_this_thread();
    const auto ticks = static_cast<std::size_t>(std::llround(options.duration_s / options.period_s));
    TimedLoop timed;
    timed.cores = static_cast<int>(cores.size());
    timed.late_us.assign(ticks, 0);
    timed.duration_us.assign(ticks, 0);
    std::jthread load;
    if (options.load) {
        load = std::jthread([core = cores.front()](const std::stop_token& stop) { work(stop, core); });
    }
    // A separate thread, so that its priority and its core assignment end with it.
    std::thread loop([&, core = cores.back()] {
        keep_this_thread_on(core);
        run(options, tick, timed);
    });
    loop.join();
    return timed;
}

} // namespace dfdyn::tools
