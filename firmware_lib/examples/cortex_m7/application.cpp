// SPDX-License-Identifier: Apache-2.0
// Runs the embedding example on a bare Cortex-M7 and reports what it took.
#include "embedding.hpp"
#include "instruction_counter.hpp"
#include "semihosting.hpp"
#include "stack_watermark.hpp"

#include <algorithm>
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

void after_tick() {
    const std::uint32_t now = instruction_counter();
    statistics.add(now - statistics.last_reading);
    statistics.last_reading = instruction_counter();
}

void report(const char* what, std::uint32_t number, const char* unit) {
    semihosting::write(what);
    semihosting::write(number);
    semihosting::write(unit);
}

void report_instructions() {
    report("cortex-m7: instructions under QEMU, not cycles, per tick: mean ",
           static_cast<std::uint32_t>(statistics.sum / statistics.ticks), "");
    report(", least ", statistics.smallest, "");
    report(", most ", statistics.largest, "");
    report(", over ", statistics.ticks, " ticks\n");
}

std::uint32_t instructions_of_loop(std::uint32_t turns) {
    const std::uint32_t before = instruction_counter();
    asm volatile("1: subs %0, %0, #1\n" // two instructions a turn
                 "bne 1b\n"
                 : "+r"(turns)
                 :
                 : "cc");
    return instruction_counter() - before;
}

bool counter_is_exact() {
    const std::uint32_t difference = instructions_of_loop(100'000) - instructions_of_loop(1'000);
    const bool exact =
        difference >= 197'999 && difference <= 198'001; // one reading is rounded by less than one
    if (!exact) {
        report("cortex-m7: 198000 instructions were counted as ", difference, "\n");
    }
    return exact;
}

bool stack_within_ceiling() {
    const std::uint32_t used = stack_used_bytes();
    report("cortex-m7: stack ", used, " bytes");
    report(" of ", DFDYN_STACK_CEILING_BYTES, " allowed\n");
    return used <= DFDYN_STACK_CEILING_BYTES;
}

} // namespace

int application() {
    start_instruction_counter();
    if (!counter_is_exact()) {
        return 4;
    }
    statistics.last_reading = instruction_counter();
    const int status = run_example(after_tick);
    if (status != 0 || statistics.ticks == 0) {
        report("cortex-m7: the example failed with status ", static_cast<std::uint32_t>(status), "\n");
        return 1;
    }
    report_instructions();
    return stack_within_ceiling() ? 0 : 2;
}
