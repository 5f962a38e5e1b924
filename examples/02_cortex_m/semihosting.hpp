// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// Output and exit through a debugger or emulator.
namespace semihosting {

/// Writes a zero-terminated text to the host's terminal.
void write(const char* text);

/// Writes a number in decimal.
void write(std::uint32_t number);

/// Ends the emulation with this exit status.
[[noreturn]] void exit(int status);

} // namespace semihosting
