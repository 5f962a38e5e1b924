// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/timing/machine.hpp"

#include "dfdyn/core/vector.hpp"
#include "tools/base/numerics/quantile.hpp"
#include "tools/base/text/number.hpp"
#include "tools/build_flags.hpp"

#include <chrono>
#include <fstream>

namespace dfdyn::tools {

namespace {

using Clock = std::chrono::steady_clock;

double nanoseconds(Clock::duration duration) {
    return std::chrono::duration<double, std::nano>(duration).count();
}

/// Returns the rest of the first line of `file` that begins with `key`; "unknown" if there is none.
std::string line_of(const char* file, const std::string& key) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        if (line.starts_with(key)) {
            const std::size_t value = line.find_first_not_of(" \t:", key.size());
            return value == std::string::npos ? "unknown" : line.substr(value);
        }
    }
    return "unknown";
}

} // namespace

double MultiplyAddProbe::run() {
    using Lanes = detail::Vector<float, detail::wide<float>>;
    constexpr int chains = 10; // more than latency × units of any processor
    constexpr int turns = 6000;
    static volatile float start = 1;
    typename Lanes::Type sums[chains];
    for (int i = 0; i < chains; ++i) {
        sums[i] = typename Lanes::Type{} + (start + static_cast<float>(i));
    }
    const typename Lanes::Type factor = typename Lanes::Type{} + 0.999F * start;
    const typename Lanes::Type summand = typename Lanes::Type{} + 0.001F * start;
    const auto begin = Clock::now();
    for (int turn = 0; turn < turns; ++turn) {
        for (auto& sum : sums) {
            sum = sum * factor + summand;
        }
    }
    const double rate = chains * turns / nanoseconds(Clock::now() - begin);
    for (const auto& sum : sums) {
        start = Lanes::total(sum) * 0 + 1; // so that the compiler cannot remove a chain
    }
    best_ = std::max(best_, rate);
    return rate;
}

double clock_cost_ns() {
    std::vector<double> distances;
    for (int i = 0; i < 1001; ++i) {
        const auto first = Clock::now();
        distances.push_back(nanoseconds(Clock::now() - first));
    }
    return median(std::move(distances));
}

bool is_optimised() {
#if defined(__OPTIMIZE__) && defined(NDEBUG)
    return true;
#else
    return false;
#endif
}

MachineFacts machine_facts() {
    MachineFacts machine;
    machine.processor = line_of("/proc/cpuinfo", "model name") + ", family " +
                        line_of("/proc/cpuinfo", "cpu family") + " model " +
                        line_of("/proc/cpuinfo", "model\t");
    machine.clock_source = "std::chrono::steady_clock over " +
                           line_of("/sys/devices/system/clocksource/clocksource0/current_clocksource", "");
    machine.build = build_flags();
    machine.clock_cost_ns = clock_cost_ns();
    machine.optimised = is_optimised();
    return machine;
}

std::vector<ReportFact> as_report_facts(const MachineFacts& machine) {
    return {{"Processor", machine.processor},
            {"Clock", machine.clock_source + "; a reading costs " + rounded_text(machine.clock_cost_ns) +
                          " ns, taken off every tick"},
            {"Build", machine.build}};
}

} // namespace dfdyn::tools
