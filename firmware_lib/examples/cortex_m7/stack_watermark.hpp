// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

extern "C" std::uint32_t stack_bottom[], stack_top[];

constexpr std::uint32_t stack_paint = 0xC5C5C5C5;

/// Fills the unused part of the stack with a pattern that stack_used_bytes() looks for.
[[gnu::always_inline]] inline void paint_stack() {
    std::uint32_t* stack_pointer = nullptr;
    asm volatile("mov %0, sp" : "=r"(stack_pointer));
    for (volatile std::uint32_t* word = stack_bottom; word < stack_pointer; ++word) {
        *word = stack_paint;
    }
}

/// The deepest that the stack has been since paint_stack(), in bytes from its top.
inline std::uint32_t stack_used_bytes() {
    const volatile std::uint32_t* word = stack_bottom;
    while (word < stack_top && *word == stack_paint) {
        ++word;
    }
    return static_cast<std::uint32_t>(stack_top - word) * 4;
}
