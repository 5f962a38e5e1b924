// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// Starts the timer that instruction_counter() reads.
void start_instruction_counter();

/// Instructions executed since the start, modulo 2^32: subtract two readings. Exact under QEMU with `-icount
/// shift=10` on the MPS2 boards; instructions, not cycles. Has to be called at least once in 160 million
/// instructions.
std::uint32_t instruction_counter();
