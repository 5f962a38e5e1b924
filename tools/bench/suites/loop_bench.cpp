// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/suites/loop_bench.hpp"

#include "tools/bench/suites/bench_arm.hpp"
#include "tools/model/run_time/runtime_estimator.hpp"

#include <cmath>
#include <utility>
#include <vector>

namespace dfdyn::tools {

LoopBench run_loop_bench(double duration_s) {
    const auto estimator = make_estimator(BenchArm::model(), true);
    BenchArm arm;
    std::vector<double> duration_us;
    duration_us.reserve(static_cast<std::size_t>(std::llround(duration_s / BenchArm::period_s)));
    LoopBench bench;
    TimedLoop timed =
        time_loop({.period_s = BenchArm::period_s, .duration_s = duration_s}, [&](std::size_t row) {
            arm.move_to(row);
            const Tick tick = estimator->tick({.time_ns = std::llround(1e9 * arm.time_s()),
                                               .position = arm.position(),
                                               .velocity = {},
                                               .acceleration = {},
                                               .output = arm.torque()});
            bench.learned += tick.status.learned() ? 1 : 0;
            duration_us.push_back(1e-3 * static_cast<double>(tick.duration.count()));
        });
    bench.pace = timed.pace;
    bench.late = summarise(std::move(timed.late_us), 1);
    bench.duration = summarise(std::move(duration_us), 1);
    bench.not_real_time = timed.not_real_time;
    bench.cores = timed.cores;
    return bench;
}

} // namespace dfdyn::tools
