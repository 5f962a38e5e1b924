// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// The timer of every Cortex-M core. It counts down from `reload` (24 bits) at the core's clock rate.
struct SysTick {
    std::uint32_t control;
    std::uint32_t reload;
    std::uint32_t value;

    static constexpr std::uint32_t enabled = 1, interrupts = 2, core_clock = 4, passed_zero = 1U << 16U;
    static constexpr std::uint32_t longest = 0xFFFFFF;
};

inline volatile SysTick& systick() { return *reinterpret_cast<volatile SysTick*>(0xE000E010); }

/// Restarts the timer from `reload`, with `flags` (`SysTick::interrupts`) in addition.
inline void start_systick(std::uint32_t reload, std::uint32_t flags = 0) {
    systick().control = 0;
    systick().reload = reload;
    systick().value = 0; // any written value restarts the timer from `reload`
    systick().control = SysTick::enabled | SysTick::core_clock | flags;
}

#if defined(__ARM_ARCH_8M_MAIN__) || defined(__ARM_ARCH_8_1M_MAIN__)
inline constexpr std::uint32_t core_clock_hz = 32'000'000; // MPS3 AN547
#else
inline constexpr std::uint32_t core_clock_hz = 25'000'000; // MPS2
#endif
