// SPDX-License-Identifier: Apache-2.0
#include "instruction_counter.hpp"

namespace {

// CMSDK timer 0 of the MPS2 boards: counts down at 25 MHz of virtual time.
struct CmsdkTimer {
    std::uint32_t control;
    std::uint32_t value;
    std::uint32_t reload;
};

volatile CmsdkTimer& timer() { return *reinterpret_cast<volatile CmsdkTimer*>(0x40000000); }

std::uint32_t last_value;
std::uint64_t elapsed_ticks;

} // namespace

void start_instruction_counter() {
    timer().control = 0;
    timer().reload = 0xFFFFFFFF;
    timer().value = 0xFFFFFFFF;
    timer().control = 1;
    elapsed_ticks = 0;
    last_value = timer().value;
}

std::uint32_t instruction_counter() {
    const std::uint32_t value = timer().value;
    elapsed_ticks += last_value - value;
    last_value = value;
    // One instruction takes 1024 ns, one tick 40 ns; the nearest whole number is exact.
    return static_cast<std::uint32_t>((elapsed_ticks * 10 + 128) / 256);
}
