// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// Starts the timer that instruction_counter() reads. It is the core's SysTick, which is then not available
/// for other uses.
void start_instruction_counter();

/// Returns the instructions executed since the start, modulo 2^32; subtract two readings. Exact under QEMU
/// with `-icount shift=10` on the boards named in image.ld. Counts instructions, not cycles. Must be called
/// at least once in 500,000 instructions.
std::uint32_t instruction_counter();

/// Returns true if the counter counts a loop of known length exactly; otherwise prints a message.
bool counter_is_exact();
