// SPDX-License-Identifier: Apache-2.0
// Runs the embedding example on a bare Cortex-M, writes the result of every tick, and reports time and
// memory.
#include "embedding.hpp"
#include "instruction_counter.hpp"
#include "report.hpp"
#include "stack_watermark.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>

namespace {

struct TickStatistics {
    std::uint32_t last_reading = 0;
    std::uint32_t ticks = 0;
    std::uint32_t smallest = std::numeric_limits<std::uint32_t>::max();
    std::uint32_t largest = 0;
    std::uint64_t sum = 0;

    void add(std::uint32_t instructions) {
        ++ticks;
        smallest = std::min(smallest, instructions);
        largest = std::max(largest, instructions);
        sum += instructions;
    }
};

TickStatistics statistics;

void measure(const TickOutcome& /*outcome*/) {
    const std::uint32_t now = instruction_counter();
    statistics.add(now - statistics.last_reading);
    statistics.last_reading = instruction_counter();
}

void write_values(const std::array<double, 6>& values) {
    for (const double value : values) {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        report(" ", static_cast<std::uint32_t>(bits >> 32U), " ");
        report("", static_cast<std::uint32_t>(bits), "");
    }
}

void write_outcome(const TickOutcome& outcome) {
    report(" ", outcome.predicted ? 1 : 0, " ");
    report("", outcome.learned ? 1 : 0, "");
    write_values(outcome.prediction);
    write_values(outcome.standard_deviation);
    semihosting::write("\n");
}

bool stack_within_ceiling() {
    const std::uint32_t used = stack_used_bytes();
    report(DFDYN_CORE ": stack ", used, " bytes");
    report(" of ", DFDYN_STACK_CEILING_BYTES, " allowed\n");
    return used <= DFDYN_STACK_CEILING_BYTES;
}

bool run_and_measure() {
    start_instruction_counter();
    statistics.last_reading = instruction_counter();
    const int status = run_example(measure);
    if (status != 0 || statistics.ticks == 0) {
        report(DFDYN_CORE ": the example failed with status ", static_cast<std::uint32_t>(status), "\n");
        return false;
    }
    report(DFDYN_CORE ": instructions under QEMU, not cycles, per tick: mean ",
           static_cast<std::uint32_t>(statistics.sum / statistics.ticks), "");
    report(", least ", statistics.smallest, "");
    report(", most ", statistics.largest, "");
    report(", over ", statistics.ticks, " ticks\n");
    return true;
}

} // namespace

int application() {
    if (!counter_is_exact()) {
        return 4;
    }
    if (!run_and_measure()) {
        return 1;
    }
    if (!stack_within_ceiling()) {
        return 2;
    }
    run_example([](const TickOutcome& outcome) {
        semihosting::write("ticks:");
        write_outcome(outcome);
    });
#ifdef DFDYN_CORE_HAS_DOUBLE
    const int status = run_example_in_double([](const TickOutcome& outcome) {
        semihosting::write("ticks in double:");
        write_outcome(outcome);
    });
    return status == 0 ? 0 : 1;
#else
    return 0;
#endif
}
