// SPDX-License-Identifier: Apache-2.0
#include "instruction_counter.hpp"

#include "report.hpp"
#include "systick.hpp"

namespace {

std::uint32_t last_value;
std::uint64_t elapsed_ticks;

/// Not inlined, so that the overhead is the same for every loop.
[[gnu::noinline]] std::uint32_t instructions_of_loop(std::uint32_t turns) {
    const std::uint32_t before = instruction_counter();
    asm volatile("1: subs %0, %0, #1\n" // two instructions per turn
                 "bne 1b\n"
                 : "+r"(turns)
                 :
                 : "cc");
    return instruction_counter() - before;
}

} // namespace

void start_instruction_counter() {
    start_systick(SysTick::longest);
    elapsed_ticks = 0;
    last_value = systick().value;
}

[[gnu::noinline]] std::uint32_t instruction_counter() {
    const std::uint32_t value = systick().value;
    elapsed_ticks += (last_value - value) & SysTick::longest;
    last_value = value;
    // One instruction takes 1024 ns; rounding to the nearest instruction is exact.
    constexpr std::uint64_t denominator = 1024ULL * (core_clock_hz / 125'000);
    return static_cast<std::uint32_t>((elapsed_ticks * 8000 + denominator / 2) / denominator);
}

bool counter_is_exact() {
    start_instruction_counter();
    const std::uint32_t difference = instructions_of_loop(100'000) - instructions_of_loop(1'000);
    const bool exact =
        difference >= 197'999 && difference <= 198'001; // one reading is rounded by less than one instruction
    if (!exact) {
        report(DFDYN_CORE ": 198000 instructions were counted as ", difference, "\n");
    }
    return exact;
}
