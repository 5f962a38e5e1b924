// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// Starts the timer that instruction_counter() reads: the core's own SysTick, so that no other use can be
/// made of it.
void start_instruction_counter();

/// Instructions executed since the start, modulo 2^32: subtract two readings. Exact under QEMU with `-icount
/// shift=10` on the boards named in image.ld; instructions, not cycles. Has to be called at least once in
/// 500,000 instructions.
std::uint32_t instruction_counter();

/// Whether the counter counts a loop of known length exactly; says so if not.
bool counter_is_exact();
