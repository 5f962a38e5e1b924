// SPDX-License-Identifier: Apache-2.0
// Runs the joint controller in a 1 kHz timer interrupt and moves the simulated joints for some seconds.
#include "closed_loop.hpp"
#include "report.hpp"
#include "stack_watermark.hpp"
#include "systick.hpp"

#include <algorithm>

namespace {

constexpr std::uint32_t timer_hz = 1000;
constexpr std::uint32_t seconds = 6;

ClosedLoop loop;
std::uint32_t ticks = 0;
/// Longest interrupt including the arm's simulation, in timer counts.
std::uint32_t longest = 0;
/// Interrupts that were due before the previous one had ended.
std::uint32_t overruns = 0;
float first_error = 0;
float last_error = 0;
volatile bool ended;

std::uint32_t microradians(float error_rad) { return static_cast<std::uint32_t>(1e6F * error_rad); }

} // namespace

extern "C" void systick_handler() {
    if (ended) {
        return;
    }
    static_cast<void>(systick().control); // clears the flag that the timer passed zero
    loop.tick();
    const std::uint32_t spent = systick().reload - systick().value;
    overruns += (systick().control & SysTick::passed_zero) != 0 ? 1 : 0;
    longest = std::max(longest, spent);
    if (++ticks % timer_hz == 0) {
        last_error = loop.take_error(timer_hz);
        first_error = ticks == timer_hz ? last_error : first_error;
    }
    ended = ticks == seconds * timer_hz;
}

int application() {
    if (!loop.controller().valid()) { // every effort would be 0
        semihosting::write(DFDYN_CORE ": the controller's gains are out of range\n");
        return 1;
    }
    start_systick(core_clock_hz / timer_hz - 1, SysTick::interrupts);
    while (!ended) {
        asm volatile("wfi" ::: "memory");
    }
    report(DFDYN_CORE ": joint controller: tracking error in the first second ", microradians(first_error),
           "");
    report(" urad, in the last ", microradians(last_error), " urad");
    report("; overruns ", overruns, "");
    report("; an interrupt took at most ", longest / (core_clock_hz / 1'000'000),
           " us of 1000, at 500 million instructions per second");
    report("; stack ", stack_used_bytes(), " bytes\n");
    const bool learned = loop.controller().forward().share()[1] > 0.5F;
    return overruns == 0 && learned && last_error < first_error / 2 ? 0 : 1;
}
